// Violations in the arguments of xrEndFrame.
#include <cmath>

#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

// Ends a correct frame after an alteration.
XrResult send(Application& app, void (*alter)(Frame& frame)) {
    app.prepare_visible_frame();
    alter(app.frame);
    return app.end_frame();
}
template <auto kAlter>
XrResult send(Application& app) {
    return send(app, kAlter);
}

// --- Layers as such ---

void null_layer(Frame& frame) {
    frame.layers[1] = nullptr;
}
void no_layers(Frame& frame) {
    frame.end.layers = nullptr;
}
void layer_of_another_type(Frame& frame) {
    frame.quad.type = XR_TYPE_COMPOSITION_LAYER_CYLINDER_KHR;
}
void too_many_layers(Frame& frame) {
    frame.layers.assign(XR_MIN_COMPOSITION_LAYERS_SUPPORTED + 1, frame.layers[1]);
    frame.end.layers = frame.layers.data();
    frame.end.layerCount = XR_MIN_COMPOSITION_LAYERS_SUPPORTED + 1;
}
void unknown_flags(Frame& frame) {
    frame.projection.layerFlags = 0x100;
}
void no_space(Frame& frame) {
    frame.quad.space = XR_NULL_HANDLE;
}

// --- Projection layers ---

void one_view(Frame& frame) {
    frame.projection.viewCount = 1;
}
void no_views(Frame& frame) {
    frame.projection.views = nullptr;
}
void untyped_view(Frame& frame) {
    frame.eyes[1].type = XR_TYPE_UNKNOWN;
}
void crooked_view(Frame& frame) {
    frame.eyes[0].pose.orientation.w *= 0.9f;
}
void moved_view(Frame& frame) {
    frame.eyes[0].pose.position.x += 0.001f;
}
void wider_view(Frame& frame) {
    frame.eyes[1].fov.angleRight += 0.001f;
}
void flipped_view(Frame& frame) {
    std::swap(frame.eyes[0].fov.angleUp, frame.eyes[0].fov.angleDown);
}
void view_of_half_a_turn(Frame& frame) {
    frame.eyes[0].fov.angleRight = 1.5708f;
}
void view_of_no_number(Frame& frame) {
    frame.eyes[0].fov.angleUp = NAN;
}

XrResult view_of_the_frame_before(Application& app) {
    app.script["timeline"] = {{{"frame", 0}, {"head", {{"at", {0, 1.6, 0}}}}},
                              {{"frame", 100}, {"head", {{"at", {1, 1.6, 0}}}}}};
    app.prepare_visible_frame();
    check(app.end_frame(), "xrEndFrame");
    const XrPosef before = app.frame.views[0].pose;
    app.prepare_frame();
    app.frame.eyes[0].pose = before;
    return app.end_frame();
}

// --- Images ---

void rectangle_outside(Frame& frame) {
    frame.quad.subImage.imageRect.offset.x = 1;
}
void rectangle_before(Frame& frame) {
    frame.quad.subImage.imageRect.offset.y = -1;
}
void empty_rectangle(Frame& frame) {
    frame.quad.subImage.imageRect.extent.width = 0;
}
void layer_beyond_the_array(Frame& frame) {
    frame.quad.subImage.imageArrayIndex = 1;
}
void layer_of_depth_as_colour(Frame& frame) {
    frame.quad.subImage.swapchain = frame.depth[0].subImage.swapchain;
}
void layer_of_colour_as_depth(Frame& frame) {
    frame.depth[0].subImage.swapchain = frame.eyes[0].subImage.swapchain;
}

XrResult image_that_was_never_drawn(Application& app) {
    app.make_session();
    const XrSwapchainCreateInfo info = app.swapchain_info(VK_FORMAT_R8G8B8A8_SRGB);
    XrSwapchain untouched = XR_NULL_HANDLE;
    check(xrCreateSwapchain(app.session, &info, &untouched), "xrCreateSwapchain");
    app.prepare_visible_frame();
    app.frame.quad.subImage.swapchain = untouched;
    return app.end_frame();
}

// Shows the image of the frame before, while the image of this frame is acquired and not released.
XrResult image_that_is_not_released(Application& app) {
    app.prepare_visible_frame();
    check(app.end_frame(), "xrEndFrame");
    const Frame shown = app.frame;
    app.poll_events();
    app.frame.state = {XR_TYPE_FRAME_STATE};
    check(xrWaitFrame(app.session, nullptr, &app.frame.state), "xrWaitFrame");
    check(xrBeginFrame(app.session, nullptr), "xrBeginFrame");
    uint32_t index = 0;
    check(xrAcquireSwapchainImage(app.panel, nullptr, &index), "xrAcquireSwapchainImage");
    app.frame.end.displayTime = app.frame.state.predictedDisplayTime;
    app.frame.end.layerCount = 1;
    app.frame.end.layers = &shown.layers[1];
    const XrResult result = app.end_frame();
    const XrSwapchainImageWaitInfo wait = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO};
    check(xrWaitSwapchainImage(app.panel, &wait), "xrWaitSwapchainImage");
    check(xrReleaseSwapchainImage(app.panel, nullptr), "xrReleaseSwapchainImage");
    return result;
}

XrResult depth_that_is_no_attachment(Application& app) {
    app.make_session();
    XrSwapchainCreateInfo info = app.swapchain_info(VK_FORMAT_D32_SFLOAT, 2);
    info.usageFlags = XR_SWAPCHAIN_USAGE_SAMPLED_BIT;
    XrSwapchain sampled = XR_NULL_HANDLE;
    check(xrCreateSwapchain(app.session, &info, &sampled), "xrCreateSwapchain");
    app.prepare_visible_frame();
    Application::draw_to(sampled);
    app.frame.depth[0].subImage.swapchain = sampled;
    return app.end_frame();
}

// --- Depth ---

void no_depth_range(Frame& frame) {
    frame.depth[0].minDepth = frame.depth[0].maxDepth;
}
void turned_depth_range(Frame& frame) {
    std::swap(frame.depth[0].minDepth, frame.depth[0].maxDepth);
}
void wide_depth_range(Frame& frame) {
    frame.depth[1].maxDepth = 2;
}
void no_depth_planes(Frame& frame) {
    frame.depth[0].nearZ = frame.depth[0].farZ;
}
void depth_plane_at_the_eye(Frame& frame) {
    frame.depth[0].nearZ = 0;
}
void depth_of_one_view(Frame& frame) {
    frame.eyes[1].next = nullptr;
}

XrResult depth_without_extension(Application& app) {
    std::erase(app.extensions, std::string(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME));
    app.prepare_visible_frame();
    return app.end_frame();
}

// --- Quads ---

void flat_quad(Frame& frame) {
    frame.quad.size.height = 0;
}
void crooked_quad(Frame& frame) {
    frame.quad.pose.orientation.w = 0;
}
void quad_of_third_eye(Frame& frame) {
    frame.quad.eyeVisibility = XrEyeVisibility(3);
}

}  // namespace

std::vector<Violation> layer_violations() {
    const char* call = "xrEndFrame";
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE, no_layer = XR_ERROR_LAYER_INVALID;
    return {
        {"Null", "layer", call, no_layer, send<null_layer>},
        {"NoArray", "null", call, invalid, send<no_layers>},
        {"OfAnotherType", "layer", call, no_layer, send<layer_of_another_type>},
        {"TooMany", "layer-count", call, XR_ERROR_LAYER_LIMIT_EXCEEDED, send<too_many_layers>},
        {"UnknownFlags", "flags", call, invalid, send<unknown_flags>},
        {"NoSpace", "handle", call, XR_ERROR_HANDLE_INVALID, send<no_space>},
        {"OneView", "view-count", call, invalid, send<one_view>},
        {"NoViews", "null", call, invalid, send<no_views>},
        {"UntypedView", "type", call, invalid, send<untyped_view>},
        {"CrookedView", "pose", call, XR_ERROR_POSE_INVALID, send<crooked_view>},
        {"MovedView", "view-pose", call, XR_SUCCESS, send<moved_view>},
        {"ViewOfTheFrameBefore", "view-pose", call, XR_SUCCESS, view_of_the_frame_before},
        {"WiderView", "view-fov", call, XR_SUCCESS, send<wider_view>},
        {"FlippedView", "view-fov", call, XR_SUCCESS, send<flipped_view>},
        {"ViewOfHalfATurn", "fov", call, invalid, send<view_of_half_a_turn>},
        {"ViewOfNoNumber", "fov", call, invalid, send<view_of_no_number>},
        {"RectangleOutside", "swapchain-rect", call, XR_ERROR_SWAPCHAIN_RECT_INVALID, send<rectangle_outside>},
        {"RectangleBefore", "swapchain-rect", call, XR_ERROR_SWAPCHAIN_RECT_INVALID, send<rectangle_before>},
        {"EmptyRectangle", "swapchain-rect", call, XR_ERROR_SWAPCHAIN_RECT_INVALID, send<empty_rectangle>},
        {"BeyondTheArray", "swapchain-array", call, invalid, send<layer_beyond_the_array>},
        {"DepthAsColour", "swapchain-format", call, no_layer, send<layer_of_depth_as_colour>},
        {"ColourAsDepth", "swapchain-format", call, no_layer, send<layer_of_colour_as_depth>},
        {"ImageThatWasNeverDrawn", "swapchain-image", call, no_layer, image_that_was_never_drawn},
        {"ImageThatIsNotReleased", "swapchain-image", call, XR_SUCCESS, image_that_is_not_released},
        {"DepthThatIsNoAttachment", "swapchain-usage", call, XR_SUCCESS, depth_that_is_no_attachment},
        {"NoDepthRange", "depth-range", call, invalid, send<no_depth_range>},
        {"TurnedDepthRange", "depth-range", call, invalid, send<turned_depth_range>},
        {"WideDepthRange", "depth-range", call, invalid, send<wide_depth_range>},
        {"NoDepthPlanes", "depth-planes", call, invalid, send<no_depth_planes>},
        {"DepthPlaneAtTheEye", "depth-planes", call, invalid, send<depth_plane_at_the_eye>},
        {"DepthOfOneView", "depth-views", call, XR_SUCCESS, send<depth_of_one_view>},
        {"DepthWithoutExtension", "extension", call, XR_SUCCESS, depth_without_extension},
        {"FlatQuad", "quad-size", call, invalid, send<flat_quad>},
        {"CrookedQuad", "pose", call, XR_ERROR_POSE_INVALID, send<crooked_quad>},
        {"QuadOfThirdEye", "enum", call, invalid, send<quad_of_third_eye>},
    };
}

}  // namespace neuvv::test

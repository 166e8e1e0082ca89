#include "layers.h"

#include <cmath>

#include "call.h"
#include "pose.h"
#include "spaces.h"

namespace neuvv::xr_runtime {

namespace {

constexpr XrCompositionLayerFlags kKnownFlags = 7;
constexpr float kSameAngle = 1e-5f, kSamePose = 1e-5f;  // rad; m and quaternion

// The compositor shows the image that was released last. Showing an older image again is fine, unless the application
// has acquired one in this frame and not released it.
void check_released(Swapchain& swapchain, const std::string& what) {
    require(swapchain.released.has_value(), XR_ERROR_LAYER_INVALID, "swapchain-image",
            fmt::format("{}: no image of the swapchain was ever released", what));
    const bool is_stale = swapchain.released_count == swapchain.shown_count;
    if (is_stale && !swapchain.acquired.empty())
        violate("swapchain-image", fmt::format("{}: the swapchain's image of this frame is acquired, but not released "
                                               "before xrEndFrame; an old one is shown",
                                               what));
}

SubImage checked_sub_image(const XrSwapchainSubImage& sub, XrSwapchainUsageFlags usage, const std::string& what) {
    Swapchain& swapchain = object<Swapchain>(sub.swapchain);
    const XrRect2Di& rect = sub.imageRect;
    const bool is_inside = rect.offset.x >= 0 && rect.offset.y >= 0 && rect.extent.width > 0 &&
                           rect.extent.height > 0 &&
                           int64_t{rect.offset.x} + rect.extent.width <= int64_t{swapchain.info.width} &&
                           int64_t{rect.offset.y} + rect.extent.height <= int64_t{swapchain.info.height};
    require(is_inside, XR_ERROR_SWAPCHAIN_RECT_INVALID, "swapchain-rect",
            fmt::format("{}: the imageRect {} x {} at ({}, {}) is empty or outside of the swapchain's {} x {}", what,
                        rect.extent.width, rect.extent.height, rect.offset.x, rect.offset.y, swapchain.info.width,
                        swapchain.info.height));
    require(sub.imageArrayIndex < swapchain.info.arraySize, XR_ERROR_VALIDATION_FAILURE, "swapchain-array",
            fmt::format("{}: imageArrayIndex {} of a swapchain of {} layers", what, sub.imageArrayIndex,
                        swapchain.info.arraySize));
    const bool is_depth = usage == XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    require(is_depth_format(swapchain.info.format) == is_depth, XR_ERROR_LAYER_INVALID, "swapchain-format",
            fmt::format("{}: a {} format is wanted", what, is_depth ? "depth" : "colour"));
    if (is_depth && !(swapchain.info.usageFlags & usage))
        violate("swapchain-usage",
                fmt::format("{}: the swapchain lacks XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT", what));
    check_released(swapchain, what);
    return {&swapchain, rect, sub.imageArrayIndex};
}

SubImage checked_depth(const XrCompositionLayerDepthInfoKHR& info, const std::string& what) {
    const std::string name = what + " depth";
    const SubImage image = checked_sub_image(info.subImage, XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, name);
    const bool is_range = info.minDepth >= 0 && info.maxDepth <= 1 && info.minDepth < info.maxDepth;
    require(is_range, XR_ERROR_VALIDATION_FAILURE, "depth-range",
            fmt::format("{}: minDepth {} and maxDepth {} must be in 0..1 and in order", name, info.minDepth,
                        info.maxDepth));
    const bool is_planes = info.nearZ > 0 && info.farZ > 0 && info.nearZ != info.farZ;
    require(is_planes, XR_ERROR_VALIDATION_FAILURE, "depth-planes",
            fmt::format("{}: nearZ {} and farZ {} must be positive and differ", name, info.nearZ, info.farZ));
    return image;
}

void check_fov(const XrFovf& fov, uint32_t view, const Frame& frame, const std::string& what) {
    const float limit = 1.57079633f;  // exclusive; left > right and down > up are valid and mean a flipped image
    for (const float angle : {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown})
        require(std::abs(angle) < limit, XR_ERROR_VALIDATION_FAILURE, "fov",
                fmt::format("{}: the angle {} of the fov must be between -pi/2 and pi/2", what, angle));
    const XrFovf given = fov_of(view, frame.display_time, frame.follows_gaze);
    const float differences[] = {fov.angleLeft - given.angleLeft, fov.angleRight - given.angleRight,
                                 fov.angleUp - given.angleUp, fov.angleDown - given.angleDown};
    for (float difference : differences)
        if (std::abs(difference) > kSameAngle) {
            violate("view-fov", fmt::format("{}: the fov differs from the one that xrLocateViews gave", what));
            return;
        }
}

// The pose of a layer's view must be the one that xrLocateViews returned for this frame: from there the runtime assumes
// that the image was drawn.
void check_view_pose(const XrPosef& pose, const Space& space, uint32_t view, const Frame& frame,
                     const std::string& what) {
    check_pose(pose, (what + " pose").c_str());
    const Located now_there = view_in(space, view, frame.display_time);
    if (!now_there.is_valid) {
        warn("view-untracked", fmt::format("{}: submitted while the views cannot be located", what));
        return;
    }
    const float off = difference(pose, now_there.pose);
    if (off <= kSamePose) return;
    const auto& times = runtime().progress.display_times;
    for (size_t i = times.size(); i-- > 0 && times.size() - i < 8;)
        if (times[i] != frame.display_time && difference(pose, view_in(space, view, times[i]).pose) <= kSamePose) {
            violate("view-pose", fmt::format("{}: poses of another time: xrLocateViews gave this one for frame {}, not "
                                             "for the frame that is shown",
                                             what, static_cast<int64_t>(i)));
            return;
        }
    violate("view-pose",
            fmt::format("{}: the pose is not the one of xrLocateViews for the frame's display time and space", what));
}

Layer checked_projection(const XrCompositionLayerProjection& info, const Session& session, const Frame& frame,
                         const std::string& what) {
    Layer layer;
    layer.space = &object<Space>(info.space);
    const uint32_t count = view_count(session.views);
    require(info.viewCount == count, XR_ERROR_VALIDATION_FAILURE, "view-count",
            fmt::format("{}: viewCount must be {} for the session's view configuration, not {}", what, count,
                        info.viewCount));
    check_pointer(info.views, "views");
    layer.views.resize(count);
    for (uint32_t i = 0; i < count; ++i) {
        const std::string name = fmt::format("{} view {}", what, i);
        const XrCompositionLayerProjectionView& view = checked(&info.views[i]);
        layer.views[i].colour = checked_sub_image(view.subImage, XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT, name);
        check_fov(view.fov, i, frame, name);
        layer.fov.push_back(view.fov);
        check_view_pose(view.pose, *layer.space, i, frame, name);
        if (const auto* depth = chained<XrCompositionLayerDepthInfoKHR>(&view))
            layer.views[i].depth = checked_depth(checked(depth), name);
    }
    if (frame.locate_count == 0) warn("locate-views", "a projection layer of a frame without xrLocateViews");
    const auto has_depth = [](const ProjectionView& view) { return view.depth.has_value(); };
    if (!layer.has_depth() && std::any_of(layer.views.begin(), layer.views.end(), has_depth))
        violate("depth-views", what + ": depth must be given for all views or for none");
    return layer;
}

Layer checked_quad(const XrCompositionLayerQuad& info, const std::string& what) {
    Layer layer;
    layer.kind = LayerKind::kQuad;
    layer.space = &object<Space>(info.space);
    layer.image = checked_sub_image(info.subImage, XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT, what);
    check_pose(info.pose, (what + " pose").c_str());
    require(info.size.width > 0 && info.size.height > 0, XR_ERROR_VALIDATION_FAILURE, "quad-size",
            fmt::format("{}: the size {} x {} m must be positive", what, info.size.width, info.size.height));
    const bool is_known = info.eyeVisibility >= XR_EYE_VISIBILITY_BOTH && info.eyeVisibility <= XR_EYE_VISIBILITY_RIGHT;
    require(is_known, XR_ERROR_VALIDATION_FAILURE, "enum", what + ": eyeVisibility is no XrEyeVisibility");
    layer.pose = info.pose;
    layer.size = info.size;
    layer.eyes = info.eyeVisibility;
    return layer;
}

// The room may be shown only while both the passthrough and the layer run; an application that pauses one of them shows
// nothing there.
Layer checked_passthrough(const XrCompositionLayerPassthroughFB& info, const std::string& what) {
    require(runtime().instance->has(XR_FB_PASSTHROUGH_EXTENSION_NAME), XR_ERROR_LAYER_INVALID, "extension",
            what + ": XR_FB_passthrough is not enabled");
    const PassthroughLayer& images = object<PassthroughLayer>(info.layerHandle);
    const bool is_over = images.passthrough->last_frame < runtime().progress.frame();
    if (!images.is_running || !images.passthrough->is_running || is_over)
        violate("passthrough", what + ": the passthrough or its layer does not run");
    Layer layer;
    layer.kind = LayerKind::kPassthrough;
    return layer;
}

Layer checked_layer(const XrCompositionLayerBaseHeader* header, const Session& session, const Frame& frame,
                    uint32_t index) {
    require(header, XR_ERROR_LAYER_INVALID, "layer", fmt::format("layer {} is null", index));
    Layer layer;
    if (header->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
        layer = checked_projection(checked(reinterpret_cast<const XrCompositionLayerProjection*>(header)), session,
                                   frame, fmt::format("projection layer {}", index));
    } else if (header->type == XR_TYPE_COMPOSITION_LAYER_QUAD) {
        layer = checked_quad(checked(reinterpret_cast<const XrCompositionLayerQuad*>(header)),
                             fmt::format("quad layer {}", index));
    } else if (header->type == XR_TYPE_COMPOSITION_LAYER_PASSTHROUGH_FB) {
        layer = checked_passthrough(checked(reinterpret_cast<const XrCompositionLayerPassthroughFB*>(header)),
                                    fmt::format("passthrough layer {}", index));
    } else {
        refuse(XR_ERROR_LAYER_INVALID, "layer",
               fmt::format("layer {} is of the type {}, whose extension is not enabled", index, name_of(header->type)));
    }
    layer.flags = header->layerFlags;
    require((layer.flags & ~kKnownFlags) == 0, XR_ERROR_VALIDATION_FAILURE, "flags",
            fmt::format("layer {}: layerFlags {:#x} has unknown bits", index, layer.flags));
    return layer;
}

}  // namespace

std::vector<Layer> checked_layers(const XrFrameEndInfo& info, const Session& session, const Frame& frame) {
    require(info.layerCount <= XR_MIN_COMPOSITION_LAYERS_SUPPORTED, XR_ERROR_LAYER_LIMIT_EXCEEDED, "layer-count",
            fmt::format("{} layers are more than maxLayerCount", info.layerCount));
    if (info.layerCount) check_pointer(info.layers, "layers");
    std::vector<Layer> layers;
    for (uint32_t i = 0; i < info.layerCount; ++i) layers.push_back(checked_layer(info.layers[i], session, frame, i));
    return layers;
}

}  // namespace neuvv::xr_runtime

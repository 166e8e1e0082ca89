// Violations in creating and using swapchains.
#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

constexpr XrSwapchainImageWaitInfo kWait = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};

template <auto kAlter>
XrResult create(Application& app) {
    app.make_session();
    XrSwapchainCreateInfo info = app.swapchain_info(VK_FORMAT_R8G8B8A8_SRGB);
    kAlter(info);
    XrSwapchain swapchain = XR_NULL_HANDLE;
    return xrCreateSwapchain(app.session, &info, &swapchain);
}

void format_that_is_not_offered(XrSwapchainCreateInfo& info) {
    info.format = VK_FORMAT_R8_UNORM;
}
void unknown_create_flags(XrSwapchainCreateInfo& info) {
    info.createFlags = 0x100;
}
void unknown_usage_flags(XrSwapchainCreateInfo& info) {
    info.usageFlags |= 0x100;
}
void no_width(XrSwapchainCreateInfo& info) {
    info.width = 0;
}
void no_mips(XrSwapchainCreateInfo& info) {
    info.mipCount = 0;
}
void three_faces(XrSwapchainCreateInfo& info) {
    info.faceCount = 3;
}
void cube(XrSwapchainCreateInfo& info) {
    info.faceCount = 6;
}
void many_samples(XrSwapchainCreateInfo& info) {
    info.sampleCount = 4;
}
void too_wide(XrSwapchainCreateInfo& info) {
    info.width = 5000;
}
void colour_as_depth(XrSwapchainCreateInfo& info) {
    info.usageFlags = XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
}
void depth_as_colour(XrSwapchainCreateInfo& info) {
    info.format = VK_FORMAT_D32_SFLOAT;
}
// More than any device supports for an image of that size.
void too_many_mips(XrSwapchainCreateInfo& info) {
    info.mipCount = 40;
}

// --- In use ---

uint32_t acquire(XrSwapchain swapchain) {
    uint32_t index = 0;
    check(xrAcquireSwapchainImage(swapchain, nullptr, &index), "xrAcquireSwapchainImage");
    return index;
}
void wait(XrSwapchain swapchain) {
    check(xrWaitSwapchainImage(swapchain, &kWait), "xrWaitSwapchainImage");
}
void release(XrSwapchain swapchain) {
    check(xrReleaseSwapchainImage(swapchain, nullptr), "xrReleaseSwapchainImage");
}

XrResult acquire_two(Application& app) {
    app.make_session();
    acquire(app.panel);
    uint32_t index = 0;
    const XrResult result = xrAcquireSwapchainImage(app.panel, nullptr, &index);
    for (int i = 0; i < 2; ++i) {
        wait(app.panel);
        release(app.panel);
    }
    return result;
}

XrResult acquire_static_again(Application& app) {
    app.make_session();
    XrSwapchainCreateInfo info = app.swapchain_info(VK_FORMAT_R8G8B8A8_SRGB);
    info.createFlags = XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT;
    XrSwapchain image = XR_NULL_HANDLE;
    check(xrCreateSwapchain(app.session, &info, &image), "xrCreateSwapchain");
    Application::draw_to(image);
    uint32_t index = 0;
    return xrAcquireSwapchainImage(image, nullptr, &index);
}

XrResult wait_without_acquiring(Application& app) {
    app.make_session();
    return xrWaitSwapchainImage(app.panel, &kWait);
}

XrResult wait_for_image_twice(Application& app) {
    app.make_session();
    acquire(app.panel);
    wait(app.panel);
    const XrResult result = xrWaitSwapchainImage(app.panel, &kWait);
    release(app.panel);
    return result;
}

XrResult wait_less_than_nothing(Application& app) {
    app.make_session();
    acquire(app.panel);
    const XrSwapchainImageWaitInfo info = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, -1};
    const XrResult result = xrWaitSwapchainImage(app.panel, &info);
    wait(app.panel);
    release(app.panel);
    return result;
}

XrResult release_without_acquiring(Application& app) {
    app.make_session();
    return xrReleaseSwapchainImage(app.panel, nullptr);
}

XrResult release_without_waiting(Application& app) {
    app.make_session();
    acquire(app.panel);
    const XrResult result = xrReleaseSwapchainImage(app.panel, nullptr);
    wait(app.panel);
    release(app.panel);
    return result;
}

XrResult destroy_while_acquired(Application& app) {
    app.make_session();
    acquire(app.panel);
    return xrDestroySwapchain(app.panel);
}

XrResult end_while_acquired(Application& app) {
    app.make_session();
    acquire(app.panel);
    const XrResult result = xrDestroyInstance(app.instance);
    app.session = XR_NULL_HANDLE;
    app.instance = XR_NULL_HANDLE;
    return result;
}

XrResult images_of_another_type(Application& app) {
    app.make_session();
    uint32_t count = 0;
    check(xrEnumerateSwapchainImages(app.panel, 0, &count, nullptr), "xrEnumerateSwapchainImages");
    std::vector<XrSwapchainImageVulkanKHR> images(count, {XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR});
    return xrEnumerateSwapchainImages(app.panel, count, &count,
                                      reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data()));
}

}  // namespace

std::vector<Violation> swapchain_violations() {
    const char* make = "xrCreateSwapchain";
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE, unsupported = XR_ERROR_FEATURE_UNSUPPORTED;
    const XrResult out_of_order = XR_ERROR_CALL_ORDER_INVALID;
    const Severity warning = Severity::kWarning;
    return {
        {"FormatThatIsNotOffered", "swapchain-format", make, XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED,
         create<format_that_is_not_offered>},
        {"UnknownCreateFlags", "flags", make, invalid, create<unknown_create_flags>},
        {"UnknownUsageFlags", "flags", make, invalid, create<unknown_usage_flags>},
        {"NoWidth", "swapchain-size", make, invalid, create<no_width>},
        {"NoMips", "swapchain-size", make, invalid, create<no_mips>},
        {"ThreeFaces", "swapchain-size", make, invalid, create<three_faces>},
        {"Cube", "swapchain-size", make, unsupported, create<cube>},
        {"ManySamples", "swapchain-size", make, unsupported, create<many_samples>},
        {"TooWide", "swapchain-size", make, unsupported, create<too_wide>},
        {"ColourAsDepth", "swapchain-usage", make, unsupported, create<colour_as_depth>},
        {"DepthAsColour", "swapchain-usage", make, unsupported, create<depth_as_colour>},
        {"TooManyMips", "swapchain-usage", make, unsupported, create<too_many_mips>},
        {"TwoAcquired", "swapchain-order", "xrAcquireSwapchainImage", XR_SUCCESS, acquire_two, warning},
        {"StaticAcquiredAgain", "swapchain-order", "xrAcquireSwapchainImage", out_of_order, acquire_static_again},
        {"WaitedWithoutAcquiring", "swapchain-order", "xrWaitSwapchainImage", out_of_order, wait_without_acquiring},
        {"WaitedTwice", "swapchain-order", "xrWaitSwapchainImage", out_of_order, wait_for_image_twice},
        {"WaitedLessThanNothing", "time", "xrWaitSwapchainImage", invalid, wait_less_than_nothing},
        {"ReleasedWithoutAcquiring", "swapchain-order", "xrReleaseSwapchainImage", out_of_order,
         release_without_acquiring},
        {"ReleasedWithoutWaiting", "swapchain-order", "xrReleaseSwapchainImage", out_of_order, release_without_waiting},
        {"DestroyedWhileAcquired", "swapchain", "xrDestroySwapchain", XR_SUCCESS, destroy_while_acquired, warning},
        {"EndedWhileAcquired", "swapchain", "xrDestroyInstance", XR_SUCCESS, end_while_acquired, warning},
        {"ImagesOfAnotherType", "type", "xrEnumerateSwapchainImages", invalid, images_of_another_type},
    };
}

}  // namespace neuvv::test

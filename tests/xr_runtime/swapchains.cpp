// Creating swapchains, and acquiring, waiting for and releasing their images, in that order.
#include "call.h"
#include "session.h"

namespace neuvv::xr_runtime {

namespace {

constexpr XrSwapchainUsageFlags kKnownUsage = 0x7f;
constexpr uint32_t kImageCount = 3, kMaxSide = 4096, kMaxLayers = 8;

XrResult enumerate_formats(XrSession handle, uint32_t capacity, uint32_t* count, int64_t* out) {
    object<Session>(handle);
    const auto& formats = runtime().script.formats;
    return give_values(capacity, count, out, std::vector<int64_t>(formats.begin(), formats.end()));
}

void check_usage(const XrSwapchainCreateInfo& info) {
    const bool is_depth = is_depth_format(info.format);
    require((info.usageFlags & ~kKnownUsage) == 0, XR_ERROR_VALIDATION_FAILURE, "flags",
            fmt::format("XrSwapchainCreateInfo.usageFlags {:#x} has unknown bits", info.usageFlags));
    const XrSwapchainUsageFlags wrong =
        is_depth ? XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT : XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    require(!(info.usageFlags & wrong), XR_ERROR_FEATURE_UNSUPPORTED, "swapchain-usage",
            is_depth ? "a depth format cannot be a colour attachment" : "a colour format cannot be a depth attachment");
}

void check_create_info(const Session& session, const XrSwapchainCreateInfo& info) {
    const auto& formats = runtime().script.formats;
    const auto format = static_cast<VkFormat>(info.format);
    require(std::find(formats.begin(), formats.end(), format) != formats.end(), XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED,
            "swapchain-format", fmt::format("xrEnumerateSwapchainFormats does not name the format {}", info.format));
    if (runtime().script.refused_formats.contains(format)) decline(XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED);
    require((info.createFlags & ~XrSwapchainCreateFlags{3}) == 0, XR_ERROR_VALIDATION_FAILURE, "flags",
            "XrSwapchainCreateInfo.createFlags has unknown bits");
    if (info.createFlags & XR_SWAPCHAIN_CREATE_PROTECTED_CONTENT_BIT) decline(XR_ERROR_FEATURE_UNSUPPORTED);
    const bool has_size = info.width && info.height && info.arraySize && info.mipCount && info.sampleCount;
    require(has_size && (info.faceCount == 1 || info.faceCount == 6), XR_ERROR_VALIDATION_FAILURE, "swapchain-size",
            "width, height, arraySize, mipCount and sampleCount must be positive and faceCount 1 or 6");
    require(info.faceCount == 1, XR_ERROR_FEATURE_UNSUPPORTED, "swapchain-size", "there are no cube swapchains here");
    require(info.sampleCount == 1, XR_ERROR_FEATURE_UNSUPPORTED, "swapchain-size",
            "maxSwapchainSampleCount of the views is 1");
    require(info.width <= kMaxSide && info.height <= kMaxSide && info.arraySize <= kMaxLayers,
            XR_ERROR_FEATURE_UNSUPPORTED, "swapchain-size",
            fmt::format("{} x {} x {} is larger than XrSystemGraphicsProperties allow", info.width, info.height,
                        info.arraySize));
    check_usage(info);
    require(supports(session.vulkan, info), XR_ERROR_FEATURE_UNSUPPORTED, "swapchain-usage",
            fmt::format("the Vulkan device has no images of the format {} with the usage flags {:#x}", info.format,
                        info.usageFlags));
}

XrResult create_swapchain(XrSession handle, const XrSwapchainCreateInfo* create_info, XrSwapchain* out) {
    Session& session = object<Session>(handle);
    const XrSwapchainCreateInfo& info = checked(create_info);
    check_pointer(out, "swapchain");
    check_create_info(session, info);
    const bool is_static = info.createFlags & XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT;
    SwapchainImages images = create_images(session.vulkan, info, is_static ? 1 : kImageCount);
    const auto swapchain = make_object<Swapchain>();
    swapchain->session = &session;
    swapchain->info = info;
    swapchain->images = std::move(images);
    *out = swapchain->handle;
    return XR_SUCCESS;
}

XrResult destroy_swapchain(XrSwapchain handle) {
    const auto swapchain = shared<Swapchain>(handle);
    if (!swapchain->acquired.empty() && !swapchain->session->is_lost)
        warn("swapchain", "a swapchain is destroyed while one of its images is acquired");
    destroy_images(swapchain->session->vulkan, swapchain->images);
    forget(bits(handle));
    return XR_SUCCESS;
}

XrResult enumerate_images(XrSwapchain handle, uint32_t capacity, uint32_t* count, XrSwapchainImageBaseHeader* out) {
    Swapchain& swapchain = object<Swapchain>(handle);
    return give_structs(capacity, count, reinterpret_cast<XrSwapchainImageVulkanKHR*>(out),
                        swapchain.images.images.size(),
                        [&](XrSwapchainImageVulkanKHR& image, size_t i) { image.image = swapchain.images.images[i]; });
}

XrResult acquire_image(XrSwapchain handle, const XrSwapchainImageAcquireInfo* info, uint32_t* index) {
    Swapchain& swapchain = object<Swapchain>(handle);
    check_optional(info);
    check_pointer(index, "index");
    const auto count = static_cast<uint32_t>(swapchain.images.images.size());
    const bool is_static = swapchain.info.createFlags & XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT;
    require(!is_static || (swapchain.acquired.empty() && !swapchain.released), XR_ERROR_CALL_ORDER_INVALID,
            "swapchain-order", "the image of a static swapchain can be acquired once only");
    require(swapchain.acquired.size() < count, XR_ERROR_CALL_ORDER_INVALID, "swapchain-order",
            "every image of the swapchain is acquired and none of them released");
    if (!swapchain.acquired.empty()) warn("swapchain-order", "a second image of the swapchain is acquired at a time");
    *index = swapchain.next;
    swapchain.acquired.push_back(swapchain.next);
    swapchain.next = (swapchain.next + 1) % count;
    return XR_SUCCESS;
}

XrResult wait_image(XrSwapchain handle, const XrSwapchainImageWaitInfo* wait_info) {
    Swapchain& swapchain = object<Swapchain>(handle);
    const XrSwapchainImageWaitInfo& info = checked(wait_info);
    require(info.timeout >= 0, XR_ERROR_VALIDATION_FAILURE, "time", "a timeout must not be negative");
    require(!swapchain.acquired.empty(), XR_ERROR_CALL_ORDER_INVALID, "swapchain-order",
            "xrWaitSwapchainImage without an acquired image");
    require(!swapchain.is_oldest_waited, XR_ERROR_CALL_ORDER_INVALID, "swapchain-order",
            "the image waited for last must be released before another is waited for");
    swapchain.is_oldest_waited = true;
    return XR_SUCCESS;
}

XrResult release_image(XrSwapchain handle, const XrSwapchainImageReleaseInfo* info) {
    Swapchain& swapchain = object<Swapchain>(handle);
    check_optional(info);
    require(!swapchain.acquired.empty() && swapchain.is_oldest_waited, XR_ERROR_CALL_ORDER_INVALID, "swapchain-order",
            "xrReleaseSwapchainImage without an image that was acquired and waited for");
    swapchain.released = swapchain.acquired.front();
    swapchain.acquired.pop_front();
    swapchain.is_oldest_waited = false;
    ++swapchain.released_count;
    return XR_SUCCESS;
}

}  // namespace

std::vector<EntryPoint> swapchain_entries() {
    return {NEUVV_XR_ENTRY(xrEnumerateSwapchainFormats, enumerate_formats),
            NEUVV_XR_ENTRY(xrCreateSwapchain, create_swapchain),
            NEUVV_XR_ENTRY(xrDestroySwapchain, destroy_swapchain),
            NEUVV_XR_ENTRY(xrEnumerateSwapchainImages, enumerate_images),
            NEUVV_XR_ENTRY(xrAcquireSwapchainImage, acquire_image),
            NEUVV_XR_ENTRY(xrWaitSwapchainImage, wait_image),
            NEUVV_XR_ENTRY(xrReleaseSwapchainImage, release_image)};
}

}  // namespace neuvv::xr_runtime

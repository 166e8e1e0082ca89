#include "gpu/frame_capture.h"

#include <renderdoc_app.h>

#include <vector>

#include "base/platform.h"

namespace neuvv::gpu {

namespace {

// RenderDoc knows a Vulkan device by the dispatch table of its instance.
RENDERDOC_DevicePointer pointer_of(const Device& device) {
    return RENDERDOC_DEVICEPOINTER_FROM_VKINSTANCE(device.instance());
}

RENDERDOC_API_1_6_0* find_api() {
    const auto get_api =
        reinterpret_cast<pRENDERDOC_GetAPI>(function_of_loaded_library("librenderdoc.so", "RENDERDOC_GetAPI"));
    void* api = nullptr;
    if (!get_api || get_api(eRENDERDOC_API_Version_1_4_0, &api) != 1)
        throw InputError(Setting{"capture"}, "", "the program does not run under RenderDoc",
                         "start it with `renderdoccmd capture`, or from RenderDoc's window");
    return static_cast<RENDERDOC_API_1_6_0*>(api);
}

}  // namespace

FrameCapture::FrameCapture(const Device& device) : device_(device), api_(find_api()) {
    device_.wait_idle();
    api_->StartFrameCapture(pointer_of(device_), nullptr);
    capturing_ = true;
}

FrameCapture::~FrameCapture() {
    if (capturing_) api_->DiscardFrameCapture(pointer_of(device_), nullptr);
}

std::string FrameCapture::finish() {
    device_.wait_idle();
    capturing_ = false;
    if (api_->EndFrameCapture(pointer_of(device_), nullptr) != 1)
        throw RuntimeFailure("RenderDoc could not write its capture; look at its log");
    const uint32_t last = api_->GetNumCaptures() - 1;
    uint32_t length = 0;
    api_->GetCapture(last, nullptr, &length, nullptr);
    std::vector<char> path(length + 1);
    api_->GetCapture(last, path.data(), &length, nullptr);
    return path.data();
}

}  // namespace neuvv::gpu

// OpenXR as this module uses it: its headers, failures as exceptions, handles that destroy themselves.
#pragma once

#include <volk.h>

#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace neuvv::xr {

// A call that the runtime refused. One line.
struct XrFailure : RuntimeFailure {
    XrFailure(XrResult failed, const char* call, const std::string& object);
    XrResult result;
};

// Throws XrFailure naming the call, its object and the result, where it failed; else what it returned, which may be
// more than XR_SUCCESS.
XrResult check(XrResult result, const char* call, const std::string& object);

// For what one can do without: whether it worked. Throws XrFailure only where session or instance are lost.
bool works(XrResult result, const char* call, const std::string& object);

// "XR_ERROR_SESSION_LOST".
std::string result_name(XrResult result);

// Move-only.
template <typename Handle, XrResult (*Destroy)(Handle)>
class XrOwned {
  public:
    XrOwned() = default;
    ~XrOwned() { reset(); }
    XrOwned(XrOwned&& other) noexcept : handle_(std::exchange(other.handle_, XR_NULL_HANDLE)) {}
    XrOwned& operator=(XrOwned&& other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }

    Handle get() const { return handle_; }
    // For the call that makes it; it must be empty.
    Handle* out() { return &handle_; }
    void reset() {
        if (handle_ != XR_NULL_HANDLE) Destroy(std::exchange(handle_, XR_NULL_HANDLE));
    }

  private:
    Handle handle_ = XR_NULL_HANDLE;
};

using XrOwnedInstance = XrOwned<XrInstance, xrDestroyInstance>;
using XrOwnedSession = XrOwned<XrSession, xrDestroySession>;
using XrOwnedSpace = XrOwned<XrSpace, xrDestroySpace>;
using XrOwnedSwapchain = XrOwned<XrSwapchain, xrDestroySwapchain>;
using XrOwnedActionSet = XrOwned<XrActionSet, xrDestroyActionSet>;

// What a call of two steps enumerates: `call(capacity, &count, elements)`, which is asked again where there are more by
// then.
template <typename T, typename Call>
std::vector<T> enumerate(const char* name, const std::string& object, const T& blank, const Call& call) {
    std::vector<T> all;
    uint32_t count = 0;
    check(call(0, &count, nullptr), name, object);
    for (XrResult result = XR_ERROR_SIZE_INSUFFICIENT; result == XR_ERROR_SIZE_INSUFFICIENT;) {
        all.assign(count, blank);
        if (count == 0) break;
        result = call(count, &count, all.data());
        if (result != XR_ERROR_SIZE_INSUFFICIENT) check(result, name, object);
    }
    all.resize(count, blank);
    return all;
}

}  // namespace neuvv::xr

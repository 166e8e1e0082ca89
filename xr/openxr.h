// The headers of OpenXR, its failures as exceptions, and handles that destroy themselves.
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

// A call that failed in the runtime. The message is one line.
struct XrFailure : RuntimeFailure {
    XrFailure(XrResult failed, const char* call, const std::string& object);
    // Whether a new session on the same runtime may work: this one was lost, or the headset was unplugged; and whether
    // a new instance may, where the runtime has gone.
    bool session_lost() const { return result == XR_ERROR_SESSION_LOST || result == XR_ERROR_FORM_FACTOR_UNAVAILABLE; }
    bool instance_lost() const {
        return result == XR_ERROR_INSTANCE_LOST || result == XR_ERROR_RUNTIME_FAILURE ||
               result == XR_ERROR_RUNTIME_UNAVAILABLE;
    }
    XrResult result;
};

// Throws XrFailure with the names of the call, its object and the result where `result` is a failure. Otherwise returns
// `result`, which may be another success code than XR_SUCCESS.
XrResult check(XrResult result, const char* call, const std::string& object);

// For optional calls: returns whether the call succeeded. Throws XrFailure only where session or instance are lost.
bool succeeded(XrResult result, const char* call, const std::string& object);

// Such as "XR_ERROR_SESSION_LOST".
std::string result_name(XrResult result);

// A handle that is destroyed with this object. Move-only.
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
    // For the call that creates the handle; there must be none yet.
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

// Returns all elements of OpenXR's two-call idiom: `call(capacity, &count, elements)` is called for the count first,
// and then for the elements, again where their number has grown meanwhile. `blank` is what each element is before the
// call fills it. Throws XrFailure, with `name` as the call.
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

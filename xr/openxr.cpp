#include "xr/openxr.h"

#include <fmt/format.h>

#include <openxr/openxr_reflection.h>

namespace neuvv::xr {

std::string result_name(XrResult result) {
    switch (result) {
#define NEUVV_CASE(name, value) \
    case name:                  \
        return #name;
        XR_LIST_ENUM_XrResult(NEUVV_CASE)
#undef NEUVV_CASE
            default : return fmt::format("XrResult {}", static_cast<int>(result));
    }
}

XrFailure::XrFailure(XrResult failed, const char* call, const std::string& object)
    : RuntimeFailure(fmt::format("{} failed for \"{}\": {}", call, object, result_name(failed))), result(failed) {}

XrResult check(XrResult result, const char* call, const std::string& object) {
    if (XR_FAILED(result)) throw XrFailure(result, call, object);
    return result;
}

bool succeeded(XrResult result, const char* call, const std::string& object) {
    if (result == XR_ERROR_SESSION_LOST || result == XR_ERROR_INSTANCE_LOST) throw XrFailure(result, call, object);
    return XR_SUCCEEDED(result);
}

}  // namespace neuvv::xr

// What OpenXR's headers say of LOCAL_FLOOR, for headers that are older than 1.0.28. Numbers and names are those of the
// Khronos registry.
#pragma once

#include <openxr/openxr.h>

namespace neuvv::xr {

// LOCAL's origin on the floor below it. Runtimes of OpenXR 1.1 have this space, too, and the same number for it.
constexpr const char* kLocalFloorExtension = "XR_EXT_local_floor";
constexpr auto kLocalFloorSpace = static_cast<XrReferenceSpaceType>(1000426000);

}  // namespace neuvv::xr

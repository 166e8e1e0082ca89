// What OpenXR's headers of 1.1 say of LOCAL_FLOOR and of whether somebody wears the headset, for headers that are
// older. Numbers, names and layouts are those of the Khronos registry.
#pragma once

#include <openxr/openxr.h>

namespace neuvv::xr {

// LOCAL's origin on the floor below it. Runtimes of OpenXR 1.1 have this space, too, and the same number for it.
constexpr const char* kLocalFloorExtension = "XR_EXT_local_floor";
constexpr auto kLocalFloorSpace = static_cast<XrReferenceSpaceType>(1000426000);

// Whether somebody wears the headset.
constexpr const char* kUserPresenceExtension = "XR_EXT_user_presence";
constexpr auto kUserPresenceChanged = static_cast<XrStructureType>(1000470000);
constexpr auto kUserPresenceProperties = static_cast<XrStructureType>(1000470001);
#ifndef XR_EXT_user_presence
struct XrEventDataUserPresenceChangedEXT {
    XrStructureType type;
    const void* next;
    XrSession session;
    XrBool32 isUserPresent;
};
struct XrSystemUserPresencePropertiesEXT {
    XrStructureType type;
    void* next;
    XrBool32 supportsUserPresence;
};
#endif

}  // namespace neuvv::xr

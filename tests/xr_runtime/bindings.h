// Which inputs an action gets, of the bindings that the application suggested.
#pragma once

#include "state.h"

namespace neuvv::xr_runtime {

struct Source {
    std::string binding;  // as suggested
    std::string input;    // the profile's own path: /user/hand/right/input/trigger/value
};

// Of the session's current profile; with a subaction path only what lies below.
std::vector<Source> sources_of(const Session& session, const Action& action, XrPath subaction_path);

// The profile that the controllers at hand get: their own where the application knows it, else the simple one.
std::string fitting_profile(const Instance& instance);

}  // namespace neuvv::xr_runtime

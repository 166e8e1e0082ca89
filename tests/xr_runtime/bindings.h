// The inputs of each action, by the bindings that the application suggested.
#pragma once

#include "state.h"

namespace neuvv::xr_runtime {

struct Source {
    std::string binding;  // the path as the application suggested it
    std::string input;    // the path as the profile defines it: /user/hand/right/input/trigger/value
};

// The sources of an action in the session's current profile; with a subaction path, only those below that path.
std::vector<Source> sources_of(const Session& session, const Action& action, XrPath subaction_path);

// The profile that the runtime uses for the script's controllers: their own one where the application has suggested
// bindings for it, else the simple controller's.
std::string fitting_profile(const Instance& instance);

}  // namespace neuvv::xr_runtime

// Internal to this module: glTF that Debian's tinygltf (2.7.0) refuses, rewritten so that it reads it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace neuvv::stage {

struct MendedGltf {
    bool changed = false;
    std::vector<std::string> notes;  // what is left out
};

// Changes a document that check_gltf has passed; `folder`: of the files that it names. tinygltf needs a node for each
// channel, though channels without one are to be ignored; matrices for each skin, which are identities where they are
// missing; a spot for each spotlight; data URIs of a few media types; and buffers of all the bytes that there are.
MendedGltf mend_gltf(nlohmann::json& root, const std::string& folder);

}  // namespace neuvv::stage

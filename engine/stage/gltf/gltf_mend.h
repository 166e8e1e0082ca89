// Internal to this module: glTF that Debian's tinygltf (2.7.0) refuses, rewritten so that it reads it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace neuvv::stage {

// The attribute of a primitive to which its indices move where their accessor is sparse and has no buffer of its own.
constexpr const char* kSparseIndices = "_SPARSE_INDICES";

struct MendedGltf {
    bool changed = false;
    std::vector<std::string> notes;  // what is left out
};

// Changes a document that check_gltf has passed; `folder`: of the files that it names. tinygltf needs a node for each
// channel, though channels without one are to be ignored; matrices for each skin, which are identities where they are
// missing; a spot for each spotlight; data URIs of a few media types; buffers of all the bytes that there are; and
// indices in a buffer.
MendedGltf mend_gltf(nlohmann::json& root, const std::string& folder);

// Makes integers of whole numbers that are written as 24.0, which JSON does not tell apart, where glTF has indices and
// sizes. Returns whether there were some.
bool mend_whole_numbers(nlohmann::json& root);

}  // namespace neuvv::stage

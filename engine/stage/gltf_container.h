// Where the JSON stands in the bytes of a .gltf or .glb.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace neuvv::stage {

struct GltfContainer {
    bool binary = false;  // .glb, told by content
    size_t json_begin = 0, json_size = 0;
};

// Throws InputError naming `file` for a .glb whose header or first chunks are not sound. A .gltf is JSON as a whole.
GltfContainer find_gltf_json(const std::vector<uint8_t>& bytes, const std::string& file);

// Little-endian; offset + 4 must lie inside.
uint32_t gltf_word_at(const std::vector<uint8_t>& bytes, size_t offset);

}  // namespace neuvv::stage

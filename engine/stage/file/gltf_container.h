// Finds the JSON in the bytes of a .gltf or .glb file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace neuvv::stage {

constexpr uint32_t kGlbJson = 0x4E4F534A, kGlbBin = 0x004E4942;  // types of a .glb's chunks

struct GltfContainer {
    bool binary = false;                   // whether it is a .glb, as its first four bytes say
    size_t json_begin = 0, json_size = 0;  // bytes
    size_t bin_begin = 0, bin_size = 0;    // of the .glb's buffer; 0 where it has none
};

// A .gltf is JSON as a whole. Throws InputError naming `file` for a .glb whose header or first two chunks are invalid,
// and for a .nvv or .nvpaint.
GltfContainer find_gltf_json(const std::vector<uint8_t>& bytes, const std::string& file);

// The little-endian 32-bit integer at `offset`; offset + 4 must not exceed the size of `bytes`.
uint32_t gltf_word_at(const std::vector<uint8_t>& bytes, size_t offset);

}  // namespace neuvv::stage

// Writes a .glb: a document of JSON and the bytes of its one buffer, which grow together.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/error.h"

namespace neuvv::stage {

constexpr uint32_t kGltfFloat = 5126, kGltfUnsignedByte = 5121, kGltfUnsignedShort = 5123, kGltfUnsignedInt = 5125;

// What adds bytes may add members to `json`, too, so that references into it do not outlast such a call.
struct GlbWriter {
    nlohmann::ordered_json json;  // begins with `asset`; `accessors`, `bufferViews` and `buffers` are this struct's
    std::vector<uint8_t> bytes;

    GlbWriter();

    // Adds bytes as a buffer view, whose index it returns.
    size_t add_view(const void* data, size_t size);
    // Adds an array and its accessor, whose index it returns. `type` is glTF's: SCALAR, VEC3, MAT4 …
    template <typename T>
    size_t add(const std::vector<T>& numbers, const char* type, size_t components, uint32_t component_type) {
        const size_t view = add_view(numbers.data(), numbers.size() * sizeof(T));
        return add_accessor(view, numbers.size() / components, type, component_type);
    }
    size_t add_vectors(const std::vector<glm::vec3>& vectors);
    // Positions, with the bounds that glTF asks for; there is at least one.
    size_t add_positions(const std::vector<glm::vec3>& positions);
    // Times of keys, seconds, likewise.
    size_t add_times(const std::vector<float>& times);

    // Writes the file atomically. Throws InputError where it would have more than 4 GiB, and RuntimeFailure; `fix` is
    // what the first of these advises.
    void write(const std::filesystem::path& file, const Fix& fix) const;

  private:
    size_t add_accessor(size_t view, size_t count, const char* type, uint32_t component_type);
};

// Adds a channel, and its sampler, to an animation: accessors of times and of values, and what they move.
void add_gltf_channel(nlohmann::ordered_json& animation, size_t times, size_t values, size_t node, const char* path,
                      const char* interpolation = "LINEAR");

}  // namespace neuvv::stage

// Builds small .glb files for tests: a JSON object, and one binary buffer to which accessors are appended.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "stage/gltf/gltf_scene.h"
#include "support/temporary_folder.h"

namespace neuvv::test {

using nlohmann::json;

constexpr int kU8 = 5121, kU16 = 5123, kU32 = 5125, kF32 = 5126;

struct GlbBuilder {
    json root = {{"asset", {{"version", "2.0"}}}, {"bufferViews", json::array()}, {"accessors", json::array()}};
    std::vector<uint8_t> binary;

    // Adds bytes as a new buffer view; returns its index.
    int add_view(const void* data, size_t size) {
        while (binary.size() % 4 != 0) binary.push_back(0);
        root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}});
        const auto* bytes = static_cast<const uint8_t*>(data);
        binary.insert(binary.end(), bytes, bytes + size);
        return static_cast<int>(root["bufferViews"].size()) - 1;
    }
    template <typename T>
    int add(const std::vector<T>& values, int component_type, const std::string& type, size_t components) {
        const int view = add_view(values.data(), values.size() * sizeof(T));
        root["accessors"].push_back({{"bufferView", view},
                                     {"componentType", component_type},
                                     {"count", values.size() / components},
                                     {"type", type}});
        return static_cast<int>(root["accessors"].size()) - 1;
    }
    int floats(const std::vector<float>& values, const std::string& type, size_t components) {
        return add(values, kF32, type, components);
    }
    int vec3(const std::vector<float>& values) { return floats(values, "VEC3", 3); }
    int vec4(const std::vector<float>& values) { return floats(values, "VEC4", 4); }
    int scalar(const std::vector<float>& values) { return floats(values, "SCALAR", 1); }

    std::vector<uint8_t> bytes() const {
        json with_buffer = root;
        std::vector<uint8_t> chunk = binary;
        while (chunk.size() % 4 != 0 || chunk.empty()) chunk.push_back(0);
        if (!with_buffer.contains("buffers")) with_buffer["buffers"] = {{{"byteLength", chunk.size()}}};
        std::string text = with_buffer.dump();
        while (text.size() % 4 != 0) text += ' ';
        std::vector<uint8_t> out;
        const auto word = [&](uint32_t value) {
            for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<uint8_t>(value >> shift));
        };
        word(0x46546C67), word(2), word(static_cast<uint32_t>(12 + 8 + text.size() + 8 + chunk.size()));
        word(static_cast<uint32_t>(text.size())), word(0x4E4F534A);
        out.insert(out.end(), text.begin(), text.end());
        word(static_cast<uint32_t>(chunk.size())), word(0x004E4942);
        out.insert(out.end(), chunk.begin(), chunk.end());
        return out;
    }
};

// What the engine reads from the file.
inline stage::GltfScene scene_of(const GlbBuilder& glb) {
    const TemporaryFolder folder;
    return stage::load_gltf(folder.write(glb.bytes()));
}

}  // namespace neuvv::test

// Builds small .glb files for tests: a JSON object, and one binary buffer to which accessors are appended.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

// A folder that goes away with the object.
struct TemporaryFolder {
    std::filesystem::path path;
    TemporaryFolder() {
        static int count = 0;
        path = std::filesystem::temp_directory_path() /
               ("neuvv_stage_" + std::to_string(getpid()) + "_" + std::to_string(count++));
        std::filesystem::create_directories(path);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::filesystem::path write(const std::vector<uint8_t>& bytes, const std::string& name = "model.glb") const {
        std::ofstream file(path / name, std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return path / name;
    }
};

}  // namespace neuvv::test

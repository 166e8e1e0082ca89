#include "interchange/splat_gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/platform.h"
#include "media/image.h"

namespace neuvv::interchange {

namespace {

using Json = nlohmann::ordered_json;

constexpr uint32_t kFloat = 5126, kByte = 5121, kArrayBuffer = 34962, kPoints = 0;
constexpr const char* kExtension = "KHR_gaussian_splatting";

// The JSON and the bytes of a .glb that grow together.
struct Glb {
    Json json;
    std::vector<uint8_t> bytes;

    // Adds an array and its accessor, whose index it returns.
    template <typename T>
    size_t add(const std::vector<T>& numbers, const char* type, size_t components, uint32_t component_type) {
        const size_t offset = bytes.size(), size = numbers.size() * sizeof(T);
        bytes.resize((offset + size + 3) / 4 * 4);
        if (size > 0) std::memcpy(&bytes[offset], numbers.data(), size);
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                     {"componentType", component_type},
                                     {"count", numbers.size() / components},
                                     {"type", type}});
        return json["accessors"].size() - 1;
    }
    size_t add_vertices(const std::vector<float>& numbers, const char* type, size_t components) {
        const size_t accessor = add(numbers, type, components, kFloat);
        json["bufferViews"].back()["target"] = kArrayBuffer;
        return accessor;
    }
};

template <typename Of>
std::vector<float> columns(const Splats& splats, size_t components, const Of& of) {
    std::vector<float> numbers;
    numbers.reserve(splats.splats.size() * components);
    for (const Splat& splat : splats.splats)
        for (int c = 0; c < static_cast<int>(components); c++) numbers.push_back(of(splat, c));
    return numbers;
}

// COLOR_0, which is linear: what programs show that do not know splats.
std::vector<uint8_t> plain_colours(const Splats& splats) {
    std::vector<uint8_t> colours;
    for (const Splat& splat : splats.splats) {
        for (int c = 0; c < 3; c++) {
            const float srgb = std::clamp(0.5f + 0.28209479f * splat.colour[0][c], 0.0f, 1.0f);
            colours.push_back(static_cast<uint8_t>(255 * media::linear_from_srgb(double{srgb}) + 0.5));
        }
        colours.push_back(static_cast<uint8_t>(255 * splat.opacity + 0.5f));
    }
    return colours;
}

Json primitive_of(const Splats& splats, Glb& glb) {
    const auto positions = columns(splats, 3, [](const Splat& s, int c) { return s.centre[c]; });
    Json attributes;
    attributes["POSITION"] = glb.add_vertices(positions, "VEC3", 3);
    glm::vec3 low(1e30f), high(-1e30f);
    for (const Splat& splat : splats.splats) {
        low = glm::min(low, splat.centre);
        high = glm::max(high, splat.centre);
    }
    glb.json["accessors"].back()["min"] = {low.x, low.y, low.z};
    glb.json["accessors"].back()["max"] = {high.x, high.y, high.z};
    attributes["COLOR_0"] = glb.add(plain_colours(splats), "VEC4", 4, kByte);
    glb.json["accessors"].back()["normalized"] = true;
    glb.json["bufferViews"].back()["target"] = kArrayBuffer;
    const std::string prefix = std::string(kExtension) + ":";
    const glm::quat r(splats.rotation);
    const glm::vec4 rotation(r.x, r.y, r.z, r.w);
    attributes[prefix + "ROTATION"] =
        glb.add_vertices(columns(splats, 4, [&](const Splat&, int c) { return rotation[c]; }), "VEC4", 4);
    attributes[prefix + "SCALE"] =
        glb.add_vertices(columns(splats, 3, [](const Splat& s, int c) { return s.deviation[c]; }), "VEC3", 3);
    attributes[prefix + "OPACITY"] =
        glb.add_vertices(columns(splats, 1, [](const Splat& s, int) { return s.opacity; }), "SCALAR", 1);
    for (uint32_t l = 0; l <= splats.degree; l++)
        for (uint32_t i = 0; i <= 2 * l; i++)
            attributes[fmt::format("{}SH_DEGREE_{}_COEF_{}", prefix, l, i)] = glb.add_vertices(
                columns(splats, 3, [&](const Splat& s, int c) { return s.colour[l * l + i][c]; }), "VEC3", 3);
    return {{"attributes", attributes},
            {"mode", kPoints},
            {"extensions",
             {{kExtension,
               {{"kernel", "ellipse"},
                {"colorSpace", "srgb_rec709_display"},
                {"projection", "perspective"},
                {"sortingMethod", "cameraDistance"}}}}}};
}

// Node i has its own size during frame i, and none at other times.
Json animation_of(size_t frames, double fps, Glb& glb) {
    Json animation = {{"name", "frames"}, {"samplers", Json::array()}, {"channels", Json::array()}};
    const auto time = [&](size_t frame) { return static_cast<float>(static_cast<double>(frame) / fps); };
    for (size_t i = 0; i < frames; i++) {
        std::vector<float> times, scales;
        const auto key = [&](size_t frame, float scale) {
            times.push_back(time(frame));
            scales.insert(scales.end(), 3, scale);
        };
        if (i > 0) key(0, 0);
        key(i, 1);
        key(i + 1, i + 1 < frames ? 0.0f : 1.0f);
        const size_t input = glb.add(times, "SCALAR", 1, kFloat);
        glb.json["accessors"][input]["min"] = {times.front()};
        glb.json["accessors"][input]["max"] = {times.back()};
        animation["samplers"].push_back(
            {{"input", input}, {"output", glb.add(scales, "VEC3", 3, kFloat)}, {"interpolation", "STEP"}});
        animation["channels"].push_back({{"sampler", i}, {"target", {{"node", i}, {"path", "scale"}}}});
    }
    return animation;
}

void append_u32(std::vector<uint8_t>& bytes, size_t value) {
    for (int i = 0; i < 4; i++) bytes.push_back(static_cast<uint8_t>(value >> 8 * i));
}

void write_glb(const std::filesystem::path& file, Glb& glb) {
    glb.json["buffers"] = Json::array({{{"byteLength", glb.bytes.size()}}});
    std::string text = glb.json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const size_t size = 12 + 8 + text.size() + 8 + glb.bytes.size();
    if (size > UINT32_MAX)
        throw InputError(
            file.string(), "",
            fmt::format("would have {:.1f} GB; a .glb has at most 4 GiB", 1e-9 * static_cast<double>(size)),
            "export fewer --frames, or a file for each, as in out_%04d.glb");
    std::vector<uint8_t> head;
    for (const size_t number : {size_t{0x46546C67}, size_t{2}, size, text.size(), size_t{0x4E4F534A}})
        append_u32(head, number);
    head.insert(head.end(), text.begin(), text.end());
    append_u32(head, glb.bytes.size());
    append_u32(head, 0x004E4942);
    write_file_atomically(file, [&](const ByteSink& sink) {
        sink(head.data(), head.size());
        sink(glb.bytes.data(), glb.bytes.size());
    });
}

}  // namespace

size_t glb_bytes_of_splat(uint32_t degree) {
    return sizeof(float) * (3 + 1 + 4 + 3 + 1 + size_t{3} * sh_count(degree));
}

void write_splat_glb(const std::filesystem::path& file, std::span<const Splats> frames, double fps) {
    Glb glb;
    glb.json["asset"] = {{"version", "2.0"}, {"generator", "neuvv"}};
    glb.json["extensionsUsed"] = {kExtension};
    glb.json["scene"] = 0;
    Json nodes = Json::array(), meshes = Json::array(), shown = Json::array();
    for (size_t i = 0; i < frames.size(); i++) {
        Json node = {{"name", fmt::format("frame {}", i)}};
        if (i > 0) node["scale"] = {0, 0, 0};  // where nothing plays the animation
        if (!frames[i].splats.empty()) {       // a mesh without vertices is not valid
            meshes.push_back({{"primitives", Json::array({primitive_of(frames[i], glb)})}});
            node["mesh"] = meshes.size() - 1;
        }
        nodes.push_back(std::move(node));
        shown.push_back(i);
    }
    glb.json["scenes"] = Json::array({{{"nodes", shown}}});
    glb.json["nodes"] = std::move(nodes);
    if (!meshes.empty()) glb.json["meshes"] = std::move(meshes);
    if (frames.size() > 1) glb.json["animations"] = Json::array({animation_of(frames.size(), fps, glb)});
    write_glb(file, glb);
}

}  // namespace neuvv::interchange

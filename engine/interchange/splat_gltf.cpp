#include "interchange/splat_gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "media/image.h"
#include "stage/glb_writer.h"

namespace neuvv::interchange {

namespace {

using Json = nlohmann::ordered_json;

constexpr uint32_t kArrayBuffer = 34962, kPoints = 0;
constexpr const char* kExtension = "KHR_gaussian_splatting";

// Marks the last array as one of vertices.
void mark_vertices(stage::GlbWriter& glb) {
    glb.json["bufferViews"].back()["target"] = kArrayBuffer;
}

size_t add_vertices(stage::GlbWriter& glb, const std::vector<float>& numbers, const char* type, size_t components) {
    const size_t accessor = glb.add(numbers, type, components, stage::kGltfFloat);
    mark_vertices(glb);
    return accessor;
}

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

Json primitive_of(const Splats& splats, stage::GlbWriter& glb) {
    std::vector<glm::vec3> centres;
    for (const Splat& splat : splats.splats) centres.push_back(splat.centre);
    Json attributes;
    attributes["POSITION"] = glb.add_positions(centres);
    mark_vertices(glb);
    attributes["COLOR_0"] = glb.add(plain_colours(splats), "VEC4", 4, stage::kGltfUnsignedByte);
    glb.json["accessors"].back()["normalized"] = true;
    mark_vertices(glb);
    const std::string prefix = std::string(kExtension) + ":";
    const glm::quat r(splats.rotation);
    const glm::vec4 rotation(r.x, r.y, r.z, r.w);
    attributes[prefix + "ROTATION"] =
        add_vertices(glb, columns(splats, 4, [&](const Splat&, int c) { return rotation[c]; }), "VEC4", 4);
    attributes[prefix + "SCALE"] =
        add_vertices(glb, columns(splats, 3, [](const Splat& s, int c) { return s.deviation[c]; }), "VEC3", 3);
    attributes[prefix + "OPACITY"] =
        add_vertices(glb, columns(splats, 1, [](const Splat& s, int) { return s.opacity; }), "SCALAR", 1);
    for (uint32_t l = 0; l <= splats.degree; l++)
        for (uint32_t i = 0; i <= 2 * l; i++)
            attributes[fmt::format("{}SH_DEGREE_{}_COEF_{}", prefix, l, i)] = add_vertices(
                glb, columns(splats, 3, [&](const Splat& s, int c) { return s.colour[l * l + i][c]; }), "VEC3", 3);
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
Json animation_of(size_t frames, double fps, stage::GlbWriter& glb) {
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
        const size_t input = glb.add_times(times);
        stage::add_gltf_channel(animation, input, glb.add(scales, "VEC3", 3, stage::kGltfFloat), i, "scale", "STEP");
    }
    return animation;
}

}  // namespace

size_t glb_bytes_of_splat(uint32_t degree) {
    return sizeof(float) * (3 + 1 + 4 + 3 + 1 + size_t{3} * sh_count(degree));
}

void write_splat_glb(const std::filesystem::path& file, std::span<const Splats> frames, double fps) {
    stage::GlbWriter glb;
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
    glb.write(file, "export fewer --frames, or a file for each, as in out_%04d.glb");
}

}  // namespace neuvv::interchange

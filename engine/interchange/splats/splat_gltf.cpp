#include "interchange/splats/splat_gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "interchange/mesh/gltf_frames.h"
#include "media/image.h"

namespace neuvv::interchange {

namespace {

using Json = nlohmann::ordered_json;

constexpr uint32_t kArrayBuffer = 34962, kPoints = 0;

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
        for (int c = 0; c < static_cast<int>(components); ++c) numbers.push_back(of(splat, c));
    return numbers;
}

// COLOR_0, which is linear: what programs show that do not know splats.
std::vector<uint8_t> plain_colours(const Splats& splats) {
    std::vector<uint8_t> colours;
    for (const Splat& splat : splats.splats) {
        for (int c = 0; c < 3; ++c) {
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
    const std::string prefix = std::string(kSplatExtension) + ":";
    attributes[prefix + "ROTATION"] = add_vertices(glb,
                                                   columns(splats, 4,
                                                           [](const Splat& s, int c) {
                                                               const glm::quat& r = s.rotation;
                                                               return glm::vec4(r.x, r.y, r.z, r.w)[c];
                                                           }),
                                                   "VEC4", 4);
    attributes[prefix + "SCALE"] =
        add_vertices(glb, columns(splats, 3, [](const Splat& s, int c) { return s.deviation[c]; }), "VEC3", 3);
    attributes[prefix + "OPACITY"] =
        add_vertices(glb, columns(splats, 1, [](const Splat& s, int) { return s.opacity; }), "SCALAR", 1);
    for (uint32_t l = 0; l <= splats.degree; ++l)
        for (uint32_t i = 0; i <= 2 * l; ++i)
            attributes[fmt::format("{}SH_DEGREE_{}_COEF_{}", prefix, l, i)] = add_vertices(
                glb, columns(splats, 3, [&](const Splat& s, int c) { return s.colour[l * l + i][c]; }), "VEC3", 3);
    return {{"attributes", attributes},
            {"mode", kPoints},
            {"extensions",
             {{kSplatExtension,
               {{"kernel", "ellipse"},
                {"colorSpace", "srgb_rec709_display"},
                {"projection", "perspective"},
                {"sortingMethod", "cameraDistance"}}}}}};
}

}  // namespace

Json add_splat_mesh(const Splats& splats, stage::GlbWriter& glb) {
    return {{"primitives", Json::array({primitive_of(splats, glb)})}};
}

size_t glb_bytes_of_splat(uint32_t degree) {
    return sizeof(float) * (3 + 1 + 4 + 3 + 1 + size_t{3} * sh_count(degree));
}

void write_splat_glb(const std::filesystem::path& file, std::span<const Splats> frames, double fps,
                     const glm::dvec3& origin) {
    stage::GlbWriter glb;
    glb.json["extensionsUsed"] = {kSplatExtension};
    std::vector<Json> meshes;
    for (const Splats& splats : frames) meshes.push_back(splats.splats.empty() ? Json() : add_splat_mesh(splats, glb));
    add_gltf_frames(glb, meshes, fps, origin);
    glb.write(file, Remedy::kFewerFrames);
}

}  // namespace neuvv::interchange

#include "interchange/mesh/gltf_frames.h"

#include <fmt/format.h>

namespace neuvv::interchange {

namespace {

using Json = nlohmann::ordered_json;

// Node i has its own size during frame i, and none at other times.
Json animation_of(size_t frames, double fps, stage::GlbWriter& glb) {
    Json animation = {{"name", "frames"}, {"samplers", Json::array()}, {"channels", Json::array()}};
    const auto time = [&](size_t frame) { return static_cast<float>(static_cast<double>(frame) / fps); };
    for (size_t i = 0; i < frames; ++i) {
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

void add_gltf_frames(stage::GlbWriter& glb, const std::vector<Json>& meshes, double fps, const glm::dvec3& origin) {
    Json nodes = Json::array(), with_vertices = Json::array(), shown = Json::array();
    for (size_t i = 0; i < meshes.size(); ++i) {
        Json node = {{"name", fmt::format("frame {}", i)}};
        if (i > 0) node["scale"] = {0, 0, 0};  // where nothing plays the animation
        if (!meshes[i].is_null()) {
            with_vertices.push_back(meshes[i]);
            node["mesh"] = with_vertices.size() - 1;
        }
        nodes.push_back(std::move(node));
        shown.push_back(i);
    }
    if (origin != glm::dvec3(0)) {
        nodes.push_back({{"name", "capture"}, {"translation", {origin.x, origin.y, origin.z}}, {"children", shown}});
        shown = Json::array({nodes.size() - 1});
    }
    glb.json["scene"] = 0;
    glb.json["scenes"] = Json::array({{{"nodes", shown}}});
    glb.json["nodes"] = std::move(nodes);
    if (!with_vertices.empty()) glb.json["meshes"] = std::move(with_vertices);
    if (meshes.size() > 1) glb.json["animations"] = Json::array({animation_of(meshes.size(), fps, glb)});
}

}  // namespace neuvv::interchange

#include "interchange/stage/camera_gltf.h"

#include "stage/gltf/glb_writer.h"

namespace neuvv::interchange {

namespace {

using nlohmann::ordered_json;

constexpr double kNearPlane_m = 0.05;  // glTF requires one

}  // namespace

void write_camera_glb(const std::filesystem::path& file, const stage::CameraPath& images) {
    std::vector<float> times, turns;
    std::vector<glm::vec3> places;
    glm::dquat before = images.keys[0].world_from_camera;
    for (const stage::CameraPathKey& key : images.keys) {
        // Of one turn, there are two quaternions; not all programs take the one that is nearer to the last.
        const glm::dquat q =
            glm::dot(before, key.world_from_camera) < 0 ? -key.world_from_camera : key.world_from_camera;
        times.push_back(static_cast<float>(key.time_s));
        places.emplace_back(key.position);
        for (const double number : {q.x, q.y, q.z, q.w}) turns.push_back(static_cast<float>(number));
        before = q;
    }
    stage::GlbWriter glb;
    glb.json["scene"] = 0;
    glb.json["scenes"] = ordered_json::array({{{"nodes", {0}}}});
    glb.json["cameras"] =
        ordered_json::array({{{"type", "perspective"},
                              {"perspective",
                               {{"aspectRatio", images.width / (images.height * images.keys[0].stretch)},
                                {"yfov", images.keys[0].angle_y},
                                {"znear", kNearPlane_m}}}}});
    ordered_json node = {{"name", "camera"}, {"camera", 0}};
    node["translation"] = {places[0].x, places[0].y, places[0].z};
    node["rotation"] = std::vector<float>(turns.begin(), turns.begin() + 4);
    glb.json["nodes"] = ordered_json::array({node});
    if (times.size() > 1) {
        ordered_json animation = {{"name", "camera"}};
        const size_t time = glb.add_times(times);
        stage::add_gltf_channel(animation, time, glb.add_vectors(places), 0, "translation");
        stage::add_gltf_channel(animation, time, glb.add(turns, "VEC4", 4, stage::kGltfFloat), 0, "rotation");
        glb.json["animations"] = ordered_json::array({animation});
    }
    glb.write(file, "write fewer images a second");
}

}  // namespace neuvv::interchange

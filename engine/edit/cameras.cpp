#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "edit/document.h"
#include "edit/operations.h"

namespace neuvv::edit {

namespace {

constexpr double kNear_m = 0.05;  // glTF requires a near plane; this program has none

// The index of the camera on a node. Throws InputError where the node has none, or one that is not perspective.
size_t perspective_camera_of(const stage::StageFile& file, uint32_t node) {
    const ordered_json& json = node_of(file, node);
    const std::string place = fmt::format("/nodes/{}", node);
    if (!json.contains("camera"))
        throw InputError(file.path.string(), place, fmt::format("{} is no camera", title_of(file, node)));
    const auto index = json["camera"].get<size_t>();
    if (file.json["cameras"].at(index).value("type", "") != "perspective")
        throw InputError(file.path.string(), place,
                         fmt::format("{} is orthographic: it has no angle of view", title_of(file, node)),
                         "choose a perspective camera, or add one");
    return index;
}

}  // namespace

std::string add_camera(stage::StageFile& file, const std::string& name, double vertical_angle_rad,
                       const glm::dmat4& world_from_camera) {
    return all_or_nothing(file, [&] {
        const uint32_t node = append_node(file, {{"name", FreeNames(file).take(name.empty() ? "camera" : name)}});
        ordered_json& cameras = list_in(file.json, "cameras");
        ordered_json& json = node_of(file, node);
        json["camera"] = cameras.size();
        cameras.push_back({{"name", json["name"]},
                           {"type", "perspective"},
                           {"perspective", {{"yfov", vertical_angle_rad}, {"znear", kNear_m}}}});
        LocalTransform transform;
        transform.translation = glm::dvec3(world_from_camera[3]);
        transform.rotation = glm::normalize(glm::quat_cast(glm::dmat3(world_from_camera)));
        set_local_transform(json, transform);
        return fmt::format("added camera {}, {:.6g}° high, at {}", title_of(file, node),
                           glm::degrees(vertical_angle_rad), text_of(transform.translation));
    });
}

std::string set_camera(stage::StageFile& file, uint32_t node, double vertical_angle_rad) {
    const size_t index = perspective_camera_of(file, node);
    ordered_json& nodes = file.json.edit("nodes");
    ordered_json& cameras = file.json.edit("cameras");
    ordered_json changed = cameras[index];
    changed["perspective"]["yfov"] = vertical_angle_rad;
    const auto users = std::count_if(nodes.begin(), nodes.end(), [&](const ordered_json& other) {
        return other.contains("camera") && other["camera"] == index;
    });
    if (users > 1) {
        nodes[node]["camera"] = cameras.size();
        cameras.push_back(std::move(changed));
    } else {
        cameras[index] = std::move(changed);
    }
    return fmt::format("{}: sees {:.6g}° high", title_of(file, node), glm::degrees(vertical_angle_rad));
}

}  // namespace neuvv::edit

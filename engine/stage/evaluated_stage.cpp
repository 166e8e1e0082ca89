#include "stage/evaluated_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"

namespace neuvv::stage {

namespace {

// The node's rotation and position without its scale and shear. The direction of −Z is kept, and that of +Y as far as
// it is at a right angle to −Z.
glm::dmat4 rigid(const glm::dmat4& world_from_node) {
    const auto unit = [](const glm::dvec3& v, const glm::dvec3& otherwise) {
        const double length = glm::length(v);
        return length > 1e-12 && std::isfinite(length) ? v / length : otherwise;
    };
    const glm::dvec3 back = unit(glm::dvec3(world_from_node[2]), {0, 0, 1});
    const glm::dvec3 aside = std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 up = unit(glm::dvec3(world_from_node[1]), aside);
    const glm::dvec3 right = unit(glm::cross(up, back), unit(glm::cross(aside, back), {1, 0, 0}));
    glm::dmat4 matrix(1);
    matrix[0] = glm::dvec4(right, 0);
    matrix[1] = glm::dvec4(glm::cross(back, right), 0);
    matrix[2] = glm::dvec4(back, 0);
    matrix[3] = glm::dvec4(glm::dvec3(world_from_node[3]), 1);
    return matrix;
}

EvaluatedPerformer performer_at(const Stage& stage, uint32_t index, const EvaluatedStage& evaluated) {
    const StagePerformer& source = stage.performers[index];
    const PerformerSettings& settings = source.settings;
    EvaluatedPerformer performer;
    performer.performer = index;
    performer.clip = source.clip;
    performer.frame = static_cast<float>(frame_at(source.timeline, evaluated.time_s));
    const double turn_deg = std::fmod(settings.spin_deg_per_s * evaluated.time_s, 360);
    const double turn_rad = std::isfinite(turn_deg) ? glm::radians(turn_deg) : 0;
    const glm::dmat4& world_from_node = evaluated.pose.world_from_node[source.node];
    performer.world_from_performer = glm::rotate(world_from_node, turn_rad, glm::dvec3(0, 1, 0));
    performer.opacity = static_cast<float>(settings.opacity);
    performer.visible =
        settings.visible && stage.scene.nodes[source.node].visible && is_valid_transform(world_from_node);
    performer.casts_shadow = settings.casts_shadow;
    performer.receives_shadow = settings.receives_shadow;
    return performer;
}

EvaluatedLight light_at(const GltfScene& scene, uint32_t node, const PosedScene& pose) {
    const GltfLight& source = scene.lights[static_cast<size_t>(scene.nodes[node].light)];
    const glm::dmat4 world_from_light = rigid(pose.world_from_node[node]);
    EvaluatedLight light;
    light.node = node;
    light.kind = source.kind;
    light.position = glm::dvec3(world_from_light[3]);
    light.direction = -glm::dvec3(world_from_light[2]);
    light.intensity = source.color * source.intensity;
    light.range_m = source.range_m;
    light.cos_inner = std::cos(source.inner_cone_rad);
    light.cos_outer = std::cos(source.outer_cone_rad);
    return light;
}

EvaluatedCamera camera_at(const GltfScene& scene, uint32_t node, const PosedScene& pose) {
    const auto index = static_cast<size_t>(scene.nodes[node].camera);
    const GltfCamera& source = scene.cameras[index];
    EvaluatedCamera camera;
    camera.node = node;
    camera.name = !scene.nodes[node].name.empty() ? scene.nodes[node].name
                  : !source.name.empty()          ? source.name
                                                  : fmt::format("camera {}", index);
    camera.world_from_camera = rigid(pose.world_from_node[node]);
    camera.vertical_angle_rad = source.vertical_angle_rad;
    camera.orthographic = source.orthographic;
    return camera;
}

[[noreturn]] void fail_camera(const Stage& stage, const EvaluatedStage& evaluated, const std::string& problem) {
    std::string names;  // of the perspective cameras
    for (size_t i = 0; i < evaluated.cameras.size(); ++i)
        if (!evaluated.cameras[i].orthographic)
            names += fmt::format("{}{} \"{}\"", names.empty() ? "" : ", ", i, evaluated.cameras[i].name);
    throw InputError(stage.file.path.string(), "cameras", problem,
                     names.empty() ? Fix(Remedy::kAddCamera) : Fix("choose from " + names));
}

const EvaluatedCamera& find_camera(const Stage& stage, const std::string& name_or_index,
                                   const EvaluatedStage& evaluated) {
    const EvaluatedCamera* found = nullptr;
    for (const EvaluatedCamera& camera : evaluated.cameras) {
        if (name_or_index.empty() ? camera.orthographic : camera.name != name_or_index) continue;
        if (name_or_index.empty()) return camera;
        if (found) fail_camera(stage, evaluated, fmt::format("several are named \"{}\": give an index", name_or_index));
        found = &camera;
    }
    if (found) return *found;
    size_t index = 0;
    const char* end = name_or_index.data() + name_or_index.size();
    const auto [stop, error] = std::from_chars(name_or_index.data(), end, index);
    if (!name_or_index.empty() && error == std::errc() && stop == end && index < evaluated.cameras.size())
        return evaluated.cameras[index];
    fail_camera(stage, evaluated,
                name_or_index.empty() ? "there is no perspective one" : fmt::format("none is \"{}\"", name_or_index));
}

// The last second at which an animation moves the node or one above it; 0 where none does.
double last_motion_s(const GltfScene& scene, uint32_t node) {
    std::vector<bool> carries(scene.nodes.size());
    for (auto above = static_cast<int32_t>(node); above >= 0; above = scene.nodes[static_cast<size_t>(above)].parent)
        carries[static_cast<size_t>(above)] = true;
    double last = 0;
    for (const GltfAnimation& animation : scene.animations)
        for (const GltfChannel& channel : animation.channels)
            if (carries[channel.node] && channel.path != GltfPath::kWeights)
                last = std::max(last, static_cast<double>(channel.times.back()));
    return last;
}

}  // namespace

EvaluatedStage stage_at(const Stage& stage, double stage_s) {
    EvaluatedStage evaluated;
    evaluated.time_s = stage_s;
    evaluated.pose = pose_scene(stage.scene, kAllAnimations, stage_s);
    for (uint32_t i = 0; i < stage.performers.size(); ++i)
        evaluated.performers.push_back(performer_at(stage, i, evaluated));
    for (uint32_t i = 0; i < stage.scene.nodes.size(); ++i) {
        const GltfNode& node = stage.scene.nodes[i];
        if (!node.in_scene || !is_on_stage(evaluated.pose.world_from_node[i])) continue;
        if (node.light >= 0 && node.visible) evaluated.lights.push_back(light_at(stage.scene, i, evaluated.pose));
        if (node.camera >= 0) evaluated.cameras.push_back(camera_at(stage.scene, i, evaluated.pose));
    }
    return evaluated;
}

std::pair<glm::dvec3, glm::dvec3> performers_box(const Stage& stage, const EvaluatedStage& evaluated) {
    if (evaluated.performers.empty()) return {glm::dvec3(-1), glm::dvec3(1)};
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const EvaluatedPerformer& performer : evaluated.performers) {
        const StageClip& clip = stage.clips[performer.clip];
        for (int i = 0; i < 8; ++i) {
            const glm::dvec3 corner = clip.box_min + glm::dvec3(i & 1, i >> 1 & 1, i >> 2) * clip.box_size;
            const glm::dvec3 corner_world(performer.world_from_performer * glm::dvec4(corner, 1));
            low = glm::min(low, corner_world);
            high = glm::max(high, corner_world);
        }
    }
    return {low, high};
}

bool has_camera(const EvaluatedStage& evaluated) {
    return std::any_of(evaluated.cameras.begin(), evaluated.cameras.end(),
                       [](const EvaluatedCamera& camera) { return !camera.orthographic; });
}

namespace {

Camera pinhole_of(const Stage& stage, const EvaluatedCamera& found, const EvaluatedStage& evaluated, uint32_t width,
                  uint32_t height) {
    if (found.orthographic)
        fail_camera(stage, evaluated, fmt::format("\"{}\" is orthographic, which is not drawn", found.name));
    Camera camera;
    camera.world_from_camera = found.world_from_camera;
    camera.width = width;
    camera.height = height;
    camera.cx = 0.5 * width;
    camera.cy = 0.5 * height;
    camera.fx = camera.fy = 0.5 * height / std::tan(0.5 * found.vertical_angle_rad);
    return camera;
}

}  // namespace

Camera camera_of(const Stage& stage, const std::string& name_or_index, const EvaluatedStage& evaluated, uint32_t width,
                 uint32_t height) {
    return pinhole_of(stage, find_camera(stage, name_or_index, evaluated), evaluated, width, height);
}

CameraPath path_of_camera(const Stage& stage, const std::string& name_or_index, double fps) {
    const EvaluatedStage first = stage_at(stage, 0);
    return path_of_camera(stage, static_cast<size_t>(&find_camera(stage, name_or_index, first) - first.cameras.data()),
                          fps);
}

CameraPath path_of_camera(const Stage& stage, size_t index, double fps) {
    const auto key_at = [&](double time_s) {
        const EvaluatedStage evaluated = stage_at(stage, time_s);
        return key_of(pinhole_of(stage, evaluated.cameras.at(index), evaluated, 2, 2), time_s);
    };
    CameraPath path;
    path.interpolation = Interpolation::kLinear;
    path.keys.push_back(key_at(0));
    const double last_s = last_motion_s(stage.scene, stage_at(stage, 0).cameras.at(index).node);
    const double count = std::ceil(last_s * fps - 1e-6);
    if (!(count < static_cast<double>(kMaxPathKeys)))
        throw InputError(stage.file.path.string(), "", fmt::format("has animations of {:.6g} s", last_s),
                         "choose fewer images a second");
    for (double i = 1; i <= count; ++i) path.keys.push_back(key_at(i / fps));
    path.duration_s = path.keys.back().time_s;
    return path;
}

}  // namespace neuvv::stage

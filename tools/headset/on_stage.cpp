#include "tools/headset/on_stage.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "xr/grab.h"

namespace neuvv::headset {

void OnStage::follow_document() {
    if (stage && stage_id == editor.id()) return;
    try {
        stage = std::make_shared<const stage::Stage>(stage::make_stage(editor.file(), stage.get()));
    } catch (const InputError& error) {
        if (!stage) throw;
        editor.take_back(error.what());
    }
    stage_id = editor.id();
    clock.set_stage(stage->duration_s, stage->fps);
}

void OnStage::look_at_instant() {
    instant = stage::stage_at(*stage, clock.shown_s());
}

std::optional<uint32_t> OnStage::selected_performer() const {
    if (!stage || !editor.selected()) return std::nullopt;
    for (uint32_t i = 0; i < stage->performers.size(); i++)
        if (stage->performers[i].node == *editor.selected()) return i;
    return std::nullopt;
}

std::pair<glm::dvec3, glm::dvec3> box_of(const OnStage& on, uint32_t performer) {
    const uint32_t of = on.stage->performers[performer].clip;
    const stage::StageClip& clip = on.stage->clips[of];
    if (of < on.leaf_boxes.size()) return on.leaf_boxes[of];
    return {clip.box_min, clip.box_min + clip.box_size};
}

bool has_set(const stage::Stage& stage) {
    return std::any_of(stage.scene.nodes.begin(), stage.scene.nodes.end(),
                       [](const stage::GltfNode& node) { return node.draws_mesh(); });
}

double floor_of(const OnStage& on) {
    if (has_set(*on.stage)) return 0;
    double lowest = INFINITY;
    for (const stage::InstantPerformer& performer : on.instant.performers) {
        const auto [low, high] = box_of(on, performer.performer);
        const glm::dmat4 raised = xr::on_floor(performer.world_from_performer, low, high, 0);
        lowest = std::min(lowest, performer.world_from_performer[3].y - raised[3].y);
    }
    return std::isfinite(lowest) ? lowest : 0;
}

xr::XrRig first_rig(const OnStage& on, const xr::Pose& head) {
    constexpr double kAway_m = 2.2;
    const auto [low, high] = stage::performers_box(*on.stage, on.instant);
    const glm::dvec3 middle = 0.5 * (low + high);
    glm::dvec3 stands(middle.x, on.floor_m, high.z + kAway_m);
    double yaw = 0;
    for (const stage::InstantCamera& camera : on.instant.cameras) {
        if (camera.orthographic) continue;
        const glm::dvec3 at(camera.world_from_camera[3]), ahead = -glm::dvec3(camera.world_from_camera[2]);
        stands = {at.x, on.floor_m, at.z};
        yaw = std::atan2(-ahead.x, -ahead.z);
        break;
    }
    return xr::moved_so_that_head_stands_at({}, head, stands, yaw);
}

void carry(stage::StageInstant& instant, const stage::Stage& stage, uint32_t node, const glm::dmat4& world_from_node) {
    auto& nodes = instant.pose.world_from_node;
    const glm::dmat4 moved = world_from_node * glm::inverse(nodes[node]);
    const auto hangs_on_it = [&](uint32_t one) {
        for (auto at = static_cast<int32_t>(one); at >= 0; at = stage.scene.nodes[static_cast<size_t>(at)].parent)
            if (static_cast<uint32_t>(at) == node) return true;
        return false;
    };
    for (uint32_t i = 0; i < nodes.size(); i++)
        if (hangs_on_it(i)) nodes[i] = moved * nodes[i];
    for (stage::InstantPerformer& performer : instant.performers)
        if (hangs_on_it(stage.performers[performer.performer].node))
            performer.world_from_performer = moved * performer.world_from_performer;
    for (stage::InstantLight& light : instant.lights)
        if (hangs_on_it(light.node)) {
            light.position = moved * glm::dvec4(light.position, 1);
            light.direction = glm::normalize(glm::dvec3(moved * glm::dvec4(light.direction, 0)));
        }
}

}  // namespace neuvv::headset

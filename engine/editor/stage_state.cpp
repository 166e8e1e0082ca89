#include "editor/stage_state.h"

#include <algorithm>
#include <cmath>

#include "base/box.h"
#include "base/error.h"

namespace neuvv::editor {

void StageState::follow_document() {
    if (stage && stage_id == editor.id()) return;
    try {
        stage = std::make_shared<const stage::Stage>(stage::make_stage(editor.file(), stage.get()));
    } catch (const InputError& error) {
        if (!stage) throw;
        editor.take_back(error.what());
    }
    solid.clear();  // it is of the performers of the stage before
    stage_id = editor.id();
    editor.stage_made(*stage, stage_id);
    clock.set_stage(stage->duration_s, stage->fps);
}

void StageState::evaluate() {
    evaluated = stage::stage_at(*stage, clock.displayed_s());
}

std::optional<uint32_t> StageState::selected_performer() const {
    if (!stage || !editor.selected()) return std::nullopt;
    for (uint32_t i = 0; i < stage->performers.size(); ++i)
        if (stage->performers[i].node == *editor.selected()) return i;
    return std::nullopt;
}

std::pair<glm::dvec3, glm::dvec3> box_of(const StageState& state, uint32_t performer) {
    if (performer < state.solid.size() && state.solid[performer].leaves) return state.solid[performer].box();
    const uint32_t of = state.stage->performers[performer].clip;
    const stage::StageClip& clip = state.stage->clips[of];
    if (of < state.leaf_boxes.size()) return state.leaf_boxes[of];
    return {clip.box_min, clip.box_min + clip.box_size};
}

bool has_set(const stage::Stage& stage) {
    return std::any_of(stage.scene.nodes.begin(), stage.scene.nodes.end(),
                       [](const stage::GltfNode& node) { return node.draws_mesh(); });
}

double floor_of(const StageState& state) {
    if (has_set(*state.stage)) return 0;
    double lowest = INFINITY;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        const auto [low, high] = box_of(state, performer.performer);
        const glm::dmat4 raised = on_floor(performer.world_from_performer, low, high, 0);
        lowest = std::min(lowest, performer.world_from_performer[3].y - raised[3].y);
    }
    return std::isfinite(lowest) ? lowest : 0;
}

namespace {

// A rotation and a position, as cameras have them.
glm::dmat4 without_scale(glm::dmat4 matrix) {
    matrix[2] = glm::normalize(matrix[2]);
    matrix[0] = glm::dvec4(glm::normalize(glm::cross(glm::dvec3(matrix[1]), glm::dvec3(matrix[2]))), 0);
    matrix[1] = glm::dvec4(glm::cross(glm::dvec3(matrix[2]), glm::dvec3(matrix[0])), 0);
    return matrix;
}

}  // namespace

void move_node(stage::EvaluatedStage& evaluated, const stage::Stage& stage, uint32_t node,
               const glm::dmat4& world_from_node) {
    auto& nodes = evaluated.pose.world_from_node;
    const glm::dmat4 moved = world_from_node * glm::inverse(nodes[node]);
    const auto moves_along = [&](uint32_t one) {
        for (auto at = static_cast<int32_t>(one); at >= 0; at = stage.scene.nodes[static_cast<size_t>(at)].parent)
            if (static_cast<uint32_t>(at) == node) return true;
        return false;
    };
    for (uint32_t i = 0; i < nodes.size(); ++i)
        if (moves_along(i)) nodes[i] = moved * nodes[i];
    for (stage::EvaluatedPerformer& performer : evaluated.performers)
        if (moves_along(stage.performers[performer.performer].node))
            performer.world_from_performer = moved * performer.world_from_performer;
    for (stage::EvaluatedLight& light : evaluated.lights)
        if (moves_along(light.node)) {
            light.position = moved * glm::dvec4(light.position, 1);
            light.direction = glm::normalize(glm::dvec3(moved * glm::dvec4(light.direction, 0)));
        }
    for (stage::EvaluatedCamera& camera : evaluated.cameras)
        if (moves_along(camera.node)) camera.world_from_camera = without_scale(moved * camera.world_from_camera);
}

}  // namespace neuvv::editor

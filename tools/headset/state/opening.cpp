#include "tools/headset/state/opening.h"

#include <cmath>

#include "edit/light_values.h"

namespace neuvv::headset {

namespace {

constexpr double kMinCone_deg = 2, kMaxCone_deg = 90, kMinView_deg = 10, kMaxView_deg = 120;

// The inner half angle with which a spot keeps the softness of its edge.
double inner_for(const edit::LightValues& spot, double outer_deg) {
    return edit::inner_cone_for(edit::softness_of(spot.inner_cone_deg, spot.outer_cone_deg), outer_deg);
}

}  // namespace

std::optional<Opening> opening_of_camera(const stage::StageFile& file, uint32_t node) {
    const auto camera = edit::camera_on(file, node);
    if (!camera || camera->orthographic) return std::nullopt;
    return Opening{glm::degrees(camera->vertical_angle_rad), kMinView_deg, kMaxView_deg, "sees"};
}

std::optional<Opening> opening_of_spot(const stage::StageFile& file, uint32_t node) {
    const auto light = edit::light_on(file, node);
    if (!light || light->kind != stage::GltfLightKind::kSpot) return std::nullopt;
    return Opening{light->outer_cone_deg, kMinCone_deg, kMaxCone_deg, "shines"};
}

std::optional<Opening> opening_of(const stage::StageFile& file, uint32_t node) {
    const auto camera = opening_of_camera(file, node);
    return camera ? camera : opening_of_spot(file, node);
}

std::string set_cone(stage::StageFile& file, uint32_t node, double degrees) {
    const auto light = edit::light_on(file, node);
    const double inner_deg = light ? inner_for(*light, degrees) : 0;
    return edit::set_light(file, node, {.inner_cone_deg = inner_deg, .outer_cone_deg = degrees});
}

std::string set_opening(stage::StageFile& file, uint32_t node, double degrees) {
    if (opening_of_camera(file, node)) return edit::set_camera(file, node, glm::radians(degrees));
    return set_cone(file, node, degrees);
}

void show_opening(stage::EvaluatedStage& evaluated, const stage::StageFile& file, uint32_t node, double degrees) {
    if (opening_of_camera(file, node)) {
        for (stage::EvaluatedCamera& camera : evaluated.cameras)
            if (camera.node == node) camera.vertical_angle_rad = glm::radians(degrees);
        return;
    }
    const auto light = edit::light_on(file, node);
    for (stage::EvaluatedLight& one : evaluated.lights) {
        if (!light || one.node != node) continue;
        one.cos_outer = std::cos(glm::radians(degrees));
        one.cos_inner = std::cos(glm::radians(inner_for(*light, degrees)));
    }
}

}  // namespace neuvv::headset

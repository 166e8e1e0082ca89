#include "tools/headset/draw/markers.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>

namespace neuvv::headset {

namespace {

constexpr double kMarkerRadius_m = 0.09, kMarkerRadius_rad = 0.03;  // of a marker near by, and of one that is far away
constexpr double kMarkerFromHead_m = 0.4;                           // from the head: what is nearer has no marker
constexpr double kMarkerLine_m = 0.006, kMarkerAim_m = 1.5;
constexpr glm::vec4 kLightColour{0.9f, 0.65f, 0.15f, 1}, kCameraColour{0.35f, 0.4f, 0.45f, 1},
    kSelectedColour{0.05f, 0.42f, 0.85f, 1}, kPointedColour{0.9f, 0.9f, 0.9f, 1};

// The rotation whose −Z is the direction; its +Y is as upright as possible.
glm::dquat looking_along(glm::dvec3 direction) {
    const bool is_steep = std::abs(direction.y) > 0.999;
    return glm::quatLookAt(direction, is_steep ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0));
}

// Lines from the marker's centre to the corners, or to points of the rim, of what it shines at or sees.
void draw_cone(xr::EyeShapes& shapes, const Marker& marker, glm::dvec2 half_size, int edges, double turn_rad,
               glm::vec4 colour) {
    std::vector<glm::dvec3> rim;
    for (int i = 0; i <= edges; ++i) {
        const double angle = turn_rad + glm::two_pi<double>() * i / edges;
        const glm::dvec3 at(half_size.x * std::cos(angle), half_size.y * std::sin(angle), -1);
        rim.push_back(marker.world_from_marker * (2.5 * marker.radius_m * at));
    }
    shapes.path(rim, kMarkerLine_m, colour);
    const int step = std::max(1, edges / 4);
    for (int i = 0; i < edges; i += step)
        shapes.line(marker.world_from_marker.position, rim[static_cast<size_t>(i)], kMarkerLine_m, colour, colour);
}

void draw_light(xr::EyeShapes& shapes, const Marker& marker, const stage::EvaluatedLight& light, glm::vec4 colour) {
    shapes.ball(marker.world_from_marker.position, 0.5 * marker.radius_m, colour);
    constexpr int kEdges = 24;
    constexpr double kMaxCone = 2;  // tangent: a wider cone is drawn as this one
    if (light.kind == stage::GltfLightKind::kSpot) {
        const double cosine = std::clamp(light.cos_outer, 0.0, 1.0);
        const double tangent = std::min(kMaxCone, std::sqrt(1 - cosine * cosine) / std::max(cosine, 1e-3));
        draw_cone(shapes, marker, glm::dvec2(tangent), kEdges, 0, colour);
    } else if (light.kind == stage::GltfLightKind::kDirectional) {
        for (const glm::dvec2 beside : {glm::dvec2(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
            const glm::dvec3 from(0.5 * marker.radius_m * beside, 0),
                to(from - glm::dvec3(0, 0, 2.5 * marker.radius_m));
            shapes.line(marker.world_from_marker * from, marker.world_from_marker * to, kMarkerLine_m, colour, colour);
        }
    }
}

void draw_camera(xr::EyeShapes& shapes, const Marker& marker, const stage::EvaluatedCamera& camera, glm::vec4 colour) {
    const glm::dvec3 half(0.35 * marker.radius_m, 0.35 * marker.radius_m, 0.6 * marker.radius_m);
    const glm::dmat4 world_from_box =
        xr::matrix_of(marker.world_from_marker) * glm::translate(glm::dmat4(1), glm::dvec3(0, 0, half.z));
    shapes.solid_box(world_from_box, -half, half, colour);
    if (camera.orthographic) return;
    constexpr double kAspect = 16.0 / 9, kCorner = glm::root_two<double>();
    const double tangent = kCorner * std::tan(0.5 * std::min(camera.vertical_angle_rad, 2.2));
    draw_cone(shapes, marker, {kAspect * tangent, tangent}, 4, glm::quarter_pi<double>(), colour);
}

}  // namespace

std::vector<Marker> markers_of(const HeadsetState& state) {
    std::vector<Marker> markers;
    const auto add = [&](uint32_t node, size_t index, bool is_camera, const xr::Pose& pose) {
        const double away_m = glm::distance(pose.position, state.head);
        if (away_m > kMarkerFromHead_m)
            markers.push_back({node, index, is_camera, pose, std::max(kMarkerRadius_m, kMarkerRadius_rad * away_m)});
    };
    for (size_t i = 0; i < state.evaluated.lights.size(); ++i) {
        const stage::EvaluatedLight& light = state.evaluated.lights[i];
        add(light.node, i, false, {light.position, looking_along(light.direction)});
    }
    for (size_t i = 0; i < state.evaluated.cameras.size(); ++i) {
        const glm::dmat4& pose = state.evaluated.cameras[i].world_from_camera;
        add(state.evaluated.cameras[i].node, i, true,
            {glm::dvec3(pose[3]), glm::normalize(glm::quat_cast(glm::dmat3(pose)))});
    }
    return markers;
}

std::optional<MarkerHit> marker_on(const Ray& ray, const HeadsetState& state) {
    std::optional<MarkerHit> nearest;
    if (state.tool != HandTool::kLights) return nearest;
    for (const Marker& marker : markers_of(state)) {
        const glm::dvec3 away = marker.world_from_marker.position - ray.origin;
        const double along = glm::dot(away, ray.direction);
        if (along <= 0 || glm::length(away - along * ray.direction) > marker.radius_m) continue;
        if (!nearest || along < nearest->distance_m) nearest = MarkerHit{marker.node, along};
    }
    return nearest;
}

std::optional<uint32_t> selected_marker(const HeadsetState& state) {
    for (const Marker& marker : markers_of(state))
        if (marker.node == state.editor.selected()) return marker.node;
    return std::nullopt;
}

void draw_markers(xr::EyeShapes& shapes, const HeadsetState& state, const Hands& hands) {
    if (state.tool != HandTool::kLights) return;
    for (const Marker& marker : markers_of(state)) {
        const bool is_pointed_at = std::any_of(hands.begin(), hands.end(), [&](const Hand& hand) {
            return hand.hit.target == PointerHit::Target::kMarker && hand.hit.node == marker.node;
        });
        const bool is_selected = marker.node == state.editor.selected();
        const glm::vec4 colour = is_selected        ? kSelectedColour
                                 : is_pointed_at    ? kPointedColour
                                 : marker.is_camera ? kCameraColour
                                                    : kLightColour;
        if (marker.is_camera)
            draw_camera(shapes, marker, state.evaluated.cameras[marker.index], colour);
        else
            draw_light(shapes, marker, state.evaluated.lights[marker.index], colour);
        if (is_selected)
            shapes.line(marker.world_from_marker.position, marker.world_from_marker * glm::dvec3(0, 0, -kMarkerAim_m),
                        kMarkerLine_m, colour, glm::vec4(glm::vec3(colour), 0));
    }
}

}  // namespace neuvv::headset

// The gizmo of a light: handles for the point that it is aimed at, its cone and its range. Pure geometry, as gizmo.h.
//
//   spot          the aim, the rim of the outer cone, and the range, where it is limited
//   directional   the aim
//   point         the range, where it is limited
#pragma once

#include "stage/evaluated_stage.h"
#include "tools/viewer/tools/handle_shape.h"

namespace neuvv::viewer {

enum class LightHandle : int { kNone, kAim, kRim, kRange };

// A light in the form that its handles change. World space, metres.
struct AimedLight {
    stage::GltfLightKind kind = stage::GltfLightKind::kSpot;
    glm::dvec3 position{0};
    glm::dvec3 aim{0, 0, -1};                         // not `position`; the rim is drawn at the same distance
    double outer_cone_rad = 0.5, inner_cone_rad = 0;  // half angles; inner < outer ≤ π/2
    double range_m = 0;                               // 0: unlimited

    glm::dvec3 direction() const { return glm::normalize(aim - position); }
};
// The light with its aim at this distance in the direction in which it shines.
AimedLight aimed_light(const stage::EvaluatedLight& light, double aim_distance_m);

struct LightGizmo {
    stage::Camera camera;
    AimedLight light;
    glm::vec4 colour{1, 0.85f, 0.3f, 1};
};

// The shapes to draw, the farthest first. Empty where the aim is at the position, or either is not finite.
std::vector<HandleShape> light_shapes(const LightGizmo& gizmo);
// The handle under the pointer (pixels of the image), as handle_at selects it.
LightHandle light_handle_at(const LightGizmo& gizmo, glm::dvec2 pointer);

// The light that results when a handle is grabbed at `from` and dragged to `to` (pixels of the image). `grabbed` is the
// gizmo at the time when it was grabbed.
//
// The aim moves in the plane of the image. The outer cone changes by the angle, at the light, between the points under
// the pointers: points in the plane that contains the cone's outline, or, seen along the light, in a plane across the
// cone. Where the outer cone becomes narrower than the inner one, the inner one follows. The range changes by the
// points on the axis of the light, or, for a point light, by their distances in a plane that faces the eye.
//
// `snap`: the aim moves in steps of 0.1 m to the right and up; angles are multiples of 5°, ranges of 0.1 m.
constexpr double kAimSnap_m = 0.1, kConeSnap_deg = 5, kRangeSnap_m = 0.1;
constexpr double kMinCone_deg = 0.5, kMinRange_m = 0.01;
AimedLight dragged(const LightGizmo& grabbed, LightHandle handle, glm::dvec2 from, glm::dvec2 to, bool snap);

}  // namespace neuvv::viewer

// The gizmo of a light: handles for what it shines at, how wide and how far. Pure geometry, as gizmo.h.
//
//   spot          the point that it is aimed at; the rim of its outer cone; its range, where it has one
//   directional   the point that it is aimed at
//   point         its range, where it has one
#pragma once

#include "stage/evaluated_stage.h"
#include "tools/viewer/tools/handle_shape.h"

namespace neuvv::viewer {

enum class LightHandle : int { kNone, kAim, kRim, kRange };

// A light as its handles see it: in the world, metres.
struct AimedLight {
    stage::GltfLightKind kind = stage::GltfLightKind::kSpot;
    glm::dvec3 position{0};
    glm::dvec3 aim{0, 0, -1};  // not at `position`; its rim is drawn as far away from there as this
    double outer_cone_rad = 0.5, inner_cone_rad = 0;  // half angles; inner < outer ≤ π/2
    double range_m = 0;                               // 0: without end

    glm::dvec3 direction() const { return glm::normalize(aim - position); }
};
// Aimed at the point `reach_m` away in which it shines.
AimedLight aimed_light(const stage::EvaluatedLight& light, double reach_m);

struct LightGizmo {
    stage::Camera camera;
    AimedLight light;
    glm::vec4 colour{1, 0.85f, 0.3f, 1};
};

std::vector<HandleShape> light_shapes(const LightGizmo& gizmo);
LightHandle light_handle_at(const LightGizmo& gizmo, glm::dvec2 pointer);

// The light after a handle was grabbed at `from` and dragged to `to`; the gizmo stays as it was when it was grabbed.
// The aim moves in the image's plane; the cone opens by the angle, at the light, between the pointer's places in the
// plane of its outline, or, for who looks along the light, across it; the range grows along the light, or, of a point,
// across the view. An outer cone that comes below the inner one takes it along.
//
// `snap`: the aim in steps of 0.1 m to the right and up, angles and ranges as multiples of 5° and 0.1 m.
constexpr double kAimSnap_m = 0.1, kConeSnap_deg = 5, kRangeSnap_m = 0.1;
constexpr double kMinCone_deg = 0.5, kMinRange_m = 0.01;
AimedLight dragged(const LightGizmo& grabbed, LightHandle handle, glm::dvec2 from, glm::dvec2 to, bool snap);

}  // namespace neuvv::viewer

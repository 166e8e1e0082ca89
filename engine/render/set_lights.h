// The lights of a stage as shaders take them (shared/lights.h), and where their shadow maps look from.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>

#include "shared/lights.h"
#include "stage/camera.h"

namespace neuvv::render {

enum class SetLightKind : uint32_t { kDirectional = kLightDirectional, kPoint = kLightPoint, kSpot = kLightSpot };

// KHR_lights_punctual in world space.
struct SetLight {
    SetLightKind kind = SetLightKind::kPoint;
    glm::dvec3 position{0};          // metres
    glm::dvec3 direction{0, -1, 0};  // unit: the way the light goes
    glm::dvec3 colour{1};            // linear × intensity: candela (point, spot), lux (directional)
    double range_m = 0;              // 0: no end
    double inner_cos = 1;            // of a spot's cone; outer < inner
    double outer_cos = 0.7071067811865476;
    bool casts_shadow = false;  // spots and directional lights; points cast none
};

// Light from around.
struct SetAmbient {
    glm::dvec3 light{0};               // linear, constant: a white diffuse surface returns just this
    double environment_intensity = 1;  // factor of the environment's image, where there is one
    double environment_rotation = 0;   // radians about +Y
    bool show_environment = false;     // and it is the background
};

// Which shadows there are; costs no pipeline and no new maps.
struct SetShadows {
    bool set = true;
    bool performers = true;
};

// A light from around as a polynomial of the normal, in the order of ShaderLights::irradiance.
using Irradiance = std::array<glm::dvec3, 9>;

// The same light turned about +Y.
Irradiance turned(const Irradiance& irradiance, double rotation);

using WorldBox = std::pair<glm::dvec3, glm::dvec3>;  // low, high; metres

// The camera that sees what a spot lights, `side` pixels each way: set and performers are seen from it for their
// shadows. Cones wider than 160° are cut to that.
stage::Camera shadow_camera(const SetLight& light, uint32_t side);
// The camera of a light's map of performers' shadows: of a spot shadow_camera; a directional light's looks at the box
// from so far away that its lines are parallel within 0.6°.
stage::Camera performer_shadow_camera(const SetLight& light, const WorldBox& performers, uint32_t side);
// The matrix of ShaderLight: of a spot that camera's; of a directional light parallel, just around a box (world: low,
// high), so a texel of its map is the box's width / kSetShadowSide: where the set is wide, shadows are coarse.
glm::dmat4 shadow_matrix(const SetLight& light, const WorldBox& box);

// The first kMaxSetLights lights; the first kMaxShadows of them that cast shadows and can get maps. `set`: all that is
// posed; `performers`: those that cast shadows, if there are any.
ShaderLights pack_lights(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows,
                         const Irradiance& environment, const WorldBox& set, const std::optional<WorldBox>& performers);

}  // namespace neuvv::render

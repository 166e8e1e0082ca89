// The lights of a stage as shaders take them (shared/lights.h), and the cameras of their shadow maps.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>

#include "shared/lights.h"
#include "stage/camera.h"

namespace neuvv::render {

enum class SetLightKind : uint32_t { kDirectional = kLightDirectional, kPoint = kLightPoint, kSpot = kLightSpot };

// A light of KHR_lights_punctual in world space.
struct SetLight {
    SetLightKind kind = SetLightKind::kPoint;
    glm::dvec3 position{0};          // metres
    glm::dvec3 direction{0, -1, 0};  // unit, from the light
    glm::dvec3 colour{1};            // linear × intensity: candela (point, spot), lux (directional)
    double range_m = 0;              // 0: unlimited
    double inner_cos = 1;            // cosines of the half angles of a spot's cones; outer_cos < inner_cos
    double outer_cos = 0.7071067811865476;
    bool casts_shadow = false;  // ignored for point lights, which cast no shadow
};

// Light from all directions.
struct SetAmbient {
    glm::dvec3 light{0};  // linear, the same from all directions: the light that a white diffuse surface returns
    double environment_intensity = 1;  // factor of the environment image, where there is one
    double environment_rotation = 0;   // radians about +Y
    bool show_environment = false;     // whether it is the background, too
};

// Which shadows are drawn. Changing them needs no new pipelines or maps.
struct SetShadows {
    bool set = true;         // shadows of the set
    bool performers = true;  // shadows of performers
};

// The light that a white diffuse surface returns, as a polynomial of its normal, in the order of
// ShaderLights::irradiance.
using Irradiance = std::array<glm::dvec3, 9>;

// The same light rotated about +Y, in radians.
Irradiance turned(const Irradiance& irradiance, double rotation);

using WorldBox = std::pair<glm::dvec3, glm::dvec3>;  // low, high; metres

// The camera at a spot light that covers the light's cone with side × side pixels; the shadow maps of set and
// performers are drawn with it. Cones wider than 160° are limited to 160°.
stage::Camera shadow_camera(const SetLight& light, uint32_t side);
// The camera for a light's map of performers' shadows. For a spot it is shadow_camera. For a directional light it looks
// at the box of the performers from so far away that its rays are parallel within 0.6°.
stage::Camera performer_shadow_camera(const SetLight& light, const WorldBox& performers, uint32_t side);
// ShaderLight::clip_from_world, the projection of the set's shadow map. For a spot it is that of shadow_camera. For a
// directional light it is a parallel projection of `box`: a texel of the map is the width of the box / kSetShadowSide,
// so the shadows of a wide set are coarse.
glm::dmat4 shadow_matrix(const SetLight& light, const WorldBox& box);

// Packs the first kMaxSetLights lights. The first kMaxShadows spots and directional lights of them that cast shadows
// get shadow maps. `set` is the box of the posed set, `performers` that of the performers that cast shadows, if there
// are any.
ShaderLights pack_lights(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows,
                         const Irradiance& environment, const WorldBox& set, const std::optional<WorldBox>& performers);

}  // namespace neuvv::render

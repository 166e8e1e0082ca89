// The lights of a stage, which shine on its set and its performers, and the shadows that these cast.
#ifndef NEUVV_SHARED_LIGHTS_H
#define NEUVV_SHARED_LIGHTS_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kMaxSetLights = 16u;
CONSTEXPR uint kMaxShadows = 4u;  // lights that have shadow maps
CONSTEXPR uint kNoShadow = 0xffffffffu;

CONSTEXPR uint kLightDirectional = 0u;
CONSTEXPR uint kLightPoint = 1u;
CONSTEXPR uint kLightSpot = 2u;

CONSTEXPR float kNearestLight = 0.01f;  // metres: at smaller distances a light is as bright as at this one
CONSTEXPR float kShadowNear = 0.05f;    // metres: surfaces nearer to a spot than this cast no shadow

CONSTEXPR uint kSetShadowSide = 1024u;         // texels of a side of the set's shadow maps
CONSTEXPR uint kPerformerShadowSide = 128u;    // texels of a side of the performers' shadow maps
CONSTEXPR float kPerformerShadowSoft = 0.06f;  // metres behind a performer's surface over which its shadow sets in

struct ShaderLight {
    // The projection of the set's shadow map: reversed depth, y down; w is metres along the light's axis from a spot,
    // and 1 for directional lights.
    mat4 clip_from_world;
    // The projection of the performers' shadow map, from far away for a directional light; 0 where it has no map.
    mat4 performer_clip_from_world;
    vec4 performer_eye;  // world, metres: the eye of that projection
    vec4 position;       // world, metres; w: range in metres, 0: unlimited
    vec4 direction;      // world, unit: the direction in which the light shines
    vec4 colour;         // linear; candela of point and spot, lux of directional lights
    uint kind;
    uint shadow;       // the index of its shadow maps, kNoShadow: none
    float cone_scale;  // of a spot: its light is multiplied by clamp(cos(angle) · cone_scale + cone_offset, 0, 1)²
    float cone_offset;
};

// A uniform buffer.
struct ShaderLights {
    ShaderLight light[kMaxSetLights];
    // Ambient light and environment as a white diffuse surface reflects them, a function of its normal: the factors of
    // 1, y, z, x, xy, yz, 3z²−1, xz, x²−y².
    vec4 irradiance[9];
    vec4 ambient;      // constant ambient light, which irradiance includes
    vec4 environment;  // x: factor of the image, 0: no image; y: last mip level; z, w: cosine, sine of its rotation
    uint count;        // of lights
    uint set_shadows;  // 0: the set casts no shadows
    uint performer_shadows;  // 0: performers cast no shadows
    uint unused;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ShaderLight) == 208);
static_assert(sizeof(neuvv::ShaderLights) == 16 * 208 + 9 * 16 + 3 * 16);
#endif
#endif

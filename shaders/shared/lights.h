// The lights of a stage: what shines on its set and on its performers, and the shadows between them.
#ifndef NEUVV_SHARED_LIGHTS_H
#define NEUVV_SHARED_LIGHTS_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kMaxSetLights = 16u;
CONSTEXPR uint kMaxShadows = 4u;  // of the lights: those that have shadow maps
CONSTEXPR uint kNoShadow = 0xffffffffu;

CONSTEXPR uint kLightDirectional = 0u;
CONSTEXPR uint kLightPoint = 1u;
CONSTEXPR uint kLightSpot = 2u;

CONSTEXPR float kNearestLight = 0.01f;  // metres: nearer, a light shines as it does there
CONSTEXPR float kShadowNear = 0.05f;    // metres: what is nearer to a spot casts no shadow

CONSTEXPR uint kSetShadowSide = 1024u;         // texels of a shadow map of the set
CONSTEXPR uint kPerformerShadowSide = 128u;    // and of the performers
CONSTEXPR float kPerformerShadowSoft = 0.06f;  // metres behind a performer's surface over which its shadow sets in

struct ShaderLight {
    // Of the set's shadow map: reversed depth, y down; w is metres along the light's axis from a spot, 1 for
    // directional lights.
    mat4 clip_from_world;
    // Of the performers' shadow map, which a directional light casts from far away; 0: it has none.
    mat4 performer_clip_from_world;
    vec4 performer_eye;  // world, metres: where that looks from
    vec4 position;       // world, metres; w: range in metres, 0 for none
    vec4 direction;      // world, unit: the way the light goes
    vec4 colour;         // linear; candela of point and spot, lux of directional lights
    uint kind;
    uint shadow;       // which of the shadow maps, kNoShadow: none
    float cone_scale;  // of a spot: (cos(angle) · scale + offset), held in [0,1], squared
    float cone_offset;
};

// A uniform buffer.
struct ShaderLights {
    ShaderLight light[kMaxSetLights];
    // Light from around as a white diffuse surface returns it, by its normal: factors of 1, y, z, x, xy, yz, 3z²−1, xz,
    // x²−y².
    vec4 irradiance[9];
    vec4 ambient;      // constant light from around; part of irradiance, too
    vec4 environment;  // x: factor of the image, 0 without one; y: last mip level; z, w: cosine, sine of its rotation
    uint count;        // of lights
    uint set_shadows;  // 0: the set casts none
    uint performer_shadows;
    uint unused;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::ShaderLight) == 208);
static_assert(sizeof(neuvv::ShaderLights) == 16 * 208 + 9 * 16 + 3 * 16);
#endif
#endif

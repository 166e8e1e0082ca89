// The passes that draw the set of a stage: from triangles of a posed glTF scene to lit, linear, premultiplied colour
// and depth in metres. The vertex attributes are in shared/raster.h.
#ifndef NEUVV_SHARED_SET_H
#define NEUVV_SHARED_SET_H
#include "shared/lights.h"
#include "shared/raster.h"

NEUVV_SHARED

CONSTEXPR uint kSetBaseTexture = 0u;
CONSTEXPR uint kSetMapTextures = 1u;  // four: metallic-roughness, normal, occlusion, emissive
CONSTEXPR uint kSetEnvironment = 5u;
CONSTEXPR uint kSetMaterials = 6u;  // a SetMaterial each: kSetMaterialTexels texels
CONSTEXPR uint kSetLights = 7u;
CONSTEXPR uint kSetShadowMaps = 8u;
CONSTEXPR uint kSetPerformerShadows = 9u;
CONSTEXPR uint kSetVolumeDepth = 10u;

// Smoother surfaces get this roughness, because one sample per texel cannot resolve narrower highlights.
CONSTEXPR float kMinRoughness = 0.045f;
CONSTEXPR float kBrightest = 60000.0f;  // light is clamped to this, as it is stored in fp16

CONSTEXPR uint kSetMaterialTexels = 4u;
struct SetMaterial {
    vec4 base_colour;  // linear, straight alpha
    vec4 emissive;     // linear; w: 1 for unlit materials
    vec4 surface;      // metallic, roughness, scale of the normal map, strength of occlusion
    vec4 alpha;        // x: fragments of smaller alpha are dropped, < 0: none is; y: 1 where alpha is then set to 1
};

struct SetPush {
    mat4 clip_from_world;  // for the background: world from clip
    vec4 eye;              // world, metres; for the shadow catcher: the floor below the eye
    uint material;
    uint first_texel;  // the view's first texel in the buffer of volume depths
    uint width;        // texels of a row in that buffer
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::SetMaterial) == 16 * neuvv::kSetMaterialTexels);
static_assert(sizeof(neuvv::SetPush) == 92);
#endif
#endif

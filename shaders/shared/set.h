// The set of a stage: triangles of a posed glTF scene → lit linear premultiplied colour and depth in metres. Vertex
// attributes: shared/raster.h.
#ifndef NEUVV_SHARED_SET_H
#define NEUVV_SHARED_SET_H
#include "shared/lights.h"
#include "shared/raster.h"

NEUVV_SHARED

CONSTEXPR uint kSetBaseTexture = 0u;
CONSTEXPR uint kSetMapTextures = 1u;  // four: metallic-roughness, normal, occlusion, emissive
CONSTEXPR uint kSetEnvironment = 5u;
CONSTEXPR uint kSetMaterials = 6u;  // texels as SetMaterial says
CONSTEXPR uint kSetLights = 7u;
CONSTEXPR uint kSetShadowMaps = 8u;
CONSTEXPR uint kSetPerformerShadows = 9u;
CONSTEXPR uint kSetVolumeDepth = 10u;

// Highlights of smoother surfaces are as wide as this one's: nothing smaller is seen by one sample a texel.
CONSTEXPR float kMinRoughness = 0.045f;
CONSTEXPR float kBrightest = 60000.0f;  // of what is stored as fp16

CONSTEXPR uint kSetMaterialTexels = 4u;
struct SetMaterial {
    vec4 base_colour;  // linear, straight alpha
    vec4 emissive;     // linear; w: 1 for unlit materials
    vec4 surface;      // metallic, roughness, scale of the normal map, strength of occlusion
    vec4 alpha;        // x: cutoff, below it a fragment is dropped, < 0: none is; y: 1 where alpha counts as 1
};

struct SetPush {
    mat4 clip_from_world;  // of the background: world from clip
    vec4 eye;              // world, metres
    uint material;
    uint first_texel;  // of the view in the buffer of volume depths
    uint width;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::SetMaterial) == 16 * neuvv::kSetMaterialTexels);
static_assert(sizeof(neuvv::SetPush) == 92);
#endif
#endif

// Shadow of the set: writes depth alone; discards what a masked material cuts out. Bound by texture fetches.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/set.h"

layout(location = 0) in vec2 shaded_uv;
layout(location = 1) in float shaded_alpha;
layout(binding = kSetBaseTexture) uniform sampler2D base_texture;
layout(binding = kSetMaterials) uniform textureBuffer materials;
layout(push_constant) uniform Push { SetPush push; };

void main() {
    const int at = int(push.material * kSetMaterialTexels);
    const float alpha = texelFetch(materials, at).a * shaded_alpha * texture(base_texture, shaded_uv).a;
    if (alpha < texelFetch(materials, at + 3).x) discard;
}

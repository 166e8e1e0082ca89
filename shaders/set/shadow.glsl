// How much of a light reaches a position, by the shadow maps of the set and the soft ones of the performers. The
// includer declares
//   uniform Lights { ShaderLights lights; };
//   READ_ARRAY(float, …, set_shadow_maps);    // kSetShadowSide² reversed depths a shadow, rows
//   uniform textureBuffer performer_shadows;  // rg32f, kPerformerShadowSide² a shadow: alpha, metres from its eye
// `light` is an index of lights.light. A light without shadow maps, as every point light, casts no shadows.
#ifndef NEUVV_SHADOW_GLSL
#define NEUVV_SHADOW_GLSL
#include "arrays.glsl"
#include "shared/lights.h"

// 0 where the map's texel has something before `depth`, else 1; 1 outside of the map.
float shadow_texel(uint shadow, ivec2 texel, float depth) {
    const int side = int(kSetShadowSide);
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(side)))) return 1.0;
    const int at = (int(shadow) * side + texel.y) * side + texel.x;
    return FETCH(set_shadow_maps, at).x > depth ? 0.0 : 1.0;
}

// 1 where a position is lit, 0 in the set's shadow: the mean of 3×3 bilinear comparisons, which use 4×4 texels.
// `normal` is the unit normal of the surface, or 0 inside a volume. Against self-shadowing, the position is moved off
// its surface, and by half a texel of depth towards the light. Depths are measured along the light's axis. Of a plane
// they change over r metres of the map by at most r times the plane's slope against the map, so that it is that slope
// which counts, and not the one against the ray: at the edge of a wide cone these differ.
float set_shadow(uint light, vec3 world, vec3 normal) {
    const ShaderLight from = lights.light[light];
    if (from.shadow == kNoShadow || lights.set_shadows == 0u) return 1.0;
    const vec3 to_light =
        from.kind == kLightDirectional ? -from.direction.xyz : normalize(from.position.xyz - world);
    const float w = (from.clip_from_world * vec4(world, 1.0)).w;
    // The size of a texel at the position, metres: clip x and y grow by `scale` per metre and span 2 w.
    const float scale = length(vec3(from.clip_from_world[0].x, from.clip_from_world[1].x, from.clip_from_world[2].x));
    const float texel = 2.0 * w / (scale * float(kSetShadowSide));
    const float facing = min(abs(dot(normal, from.direction.xyz)), 1.0);
    const float along_axis = max(-dot(to_light, from.direction.xyz), 0.05);
    const vec3 lifted = world + normal * (3.0 * texel * sqrt(1.0 - facing * facing)) +
                        to_light * (0.5 * texel / along_axis + 1e-4);
    const vec4 clip = from.clip_from_world * vec4(lifted, 1.0);
    if (clip.w <= 0.0) return 1.0;
    const vec3 projected = clip.xyz / clip.w;
    const vec2 texels = (0.5 * projected.xy + 0.5) * float(kSetShadowSide) - 1.5;
    if (any(lessThan(texels, vec2(-4.0))) || any(greaterThan(texels, vec2(kSetShadowSide)))) return 1.0;
    const ivec2 first = ivec2(floor(texels));
    const vec2 share = texels - vec2(first);
    float lit = 0.0;
    for (int y = 0; y < 4; ++y) {
        const float weight_y = y == 0 ? 1.0 - share.y : y == 3 ? share.y : 1.0;
        for (int x = 0; x < 4; ++x) {
            const float weight_x = x == 0 ? 1.0 - share.x : x == 3 ? share.x : 1.0;
            lit += weight_x * weight_y * shadow_texel(from.shadow, first + ivec2(x, y), projected.z);
        }
    }
    return lit / 9.0;
}

// 1 where a position is lit, down to 1 − alpha behind a performer as seen from the light, interpolated over four
// texels. Positions less than `lift` metres behind the performer's surface stay lit, because the map is too coarse for
// a performer's shadow on itself.
float performer_shadow(uint light, vec3 world, float lift) {
    const ShaderLight from = lights.light[light];
    if (from.shadow == kNoShadow || lights.performer_shadows == 0u) return 1.0;
    const vec4 clip = from.performer_clip_from_world * vec4(world, 1.0);
    if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), vec2(clip.w)))) return 1.0;
    const int side = int(kPerformerShadowSide);
    const vec2 texels = (0.5 * clip.xy / clip.w + 0.5) * float(side) - 0.5;
    const ivec2 first = ivec2(floor(texels));
    const vec2 share = texels - vec2(first);
    const float metres = distance(from.performer_eye.xyz, world);
    float shade = 0.0;
    for (int i = 0; i < 4; ++i) {
        const ivec2 corner = ivec2(i & 1, i >> 1), texel = clamp(first + corner, ivec2(0), ivec2(side - 1));
        const vec2 weights = mix(1.0 - share, share, vec2(corner));
        const vec2 blocker = texelFetch(performer_shadows, (int(from.shadow) * side + texel.y) * side + texel.x).xy;
        if (blocker.x <= 0.0) continue;  // there the distance is undefined
        const float behind = smoothstep(0.0, kPerformerShadowSoft, metres - lift - blocker.y);
        shade += weights.x * weights.y * blocker.x * behind;
    }
    return 1.0 - shade;
}

#endif

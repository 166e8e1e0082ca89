// Shadow blur: blurs the image of the performers as a light sees them by a Gaussian, first along rows, then along
// columns (errata 15), so that the coarse map shows no steps and shadows have a penumbra.
// The first pass reads alpha and metres of rays and writes alpha and alpha · metres; the second reads these and writes
// alpha and metres. One thread per texel. Bound by its 11 fetches; trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/shadow_blur.h"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const bool kSecond = false;
READ_ARRAY(vec4, kBlurRadiance, radiance);
READ_ARRAY(float, kBlurDepth, depth);
layout(binding = kBlurFrom) uniform textureBuffer rows;
layout(binding = kBlurTo, rg32f) writeonly uniform imageBuffer map;
layout(push_constant) uniform Push { ShadowBlurPush push; };

const int kSide = int(kPerformerShadowSide);

// Alpha and alpha · metres of a texel; 0 beyond the edge.
vec2 source_texel(ivec2 texel) {
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(kSide)))) return vec2(0.0);
    if (kSecond) return texelFetch(rows, texel.y * kSide + texel.x).xy;
    const uvec2 tile = uvec2(texel) / kTile, inner = uvec2(texel) % kTile;
    const uint tiles = kPerformerShadowSide / kTile;
    const int ray = int(((push.view * tiles + tile.y) * tiles + tile.x) * kTilePixels + inner.y * kTile + inner.x);
    const float alpha = FETCH(radiance, ray).a;
    return alpha > 0.0 ? vec2(alpha, alpha * FETCH(depth, ray).x) : vec2(0.0);
}

void main() {
    const int thread = int(gl_WorkGroupID.x * kTilePixels + gl_LocalInvocationID.x);
    if (thread >= kSide * kSide) return;
    const ivec2 texel = ivec2(thread % kSide, thread / kSide);
    // Component by component: lavapipe of Mesa 22.3 gets `kSecond ? ivec2(0, 1) : ivec2(1, 0)` right in x alone.
    const ivec2 step = ivec2(kSecond ? 0 : 1, kSecond ? 1 : 0);
    vec2 sum = vec2(0.0);
    float weights = 0.0;
    for (int i = -int(kBlurRadius); i <= int(kBlurRadius); ++i) {
        const float weight = exp(-0.5 * float(i * i) / (kBlurSigma * kBlurSigma));
        sum += weight * source_texel(texel + i * step);
        weights += weight;
    }
    sum /= weights;
    if (kSecond) sum.y = sum.x > 0.0 ? sum.y / sum.x : 0.0;
    imageStore(map, int(push.first_out) + thread, vec4(sum, 0.0, 0.0));
}

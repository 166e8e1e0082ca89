// Merge: blends the intervals of several instances along a ray (shared/intervals.h) in depth order. Where they overlap,
// densities add up and colours are weighted by density. This is the exact result that the paper's Algorithm 1
// approximates (errata 11).
// Reads pages; writes radiance and depth, blended under those of nearer instances. One workgroup per tile of rays, one
// thread per ray; tiles that no instance covers end at once. Bound by memory and its latency: a header and an
// interval of each list at each end of an interval.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/intervals.h"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(binding = kMergePages, std430) buffer Pages { uvec4 pages[]; };
layout(binding = kMergePages, std430) buffer Heads { uint heads[]; };
layout(binding = kMergeCovered) uniform utextureBuffer covered;
UPDATE_ARRAY(vec4, kMergeRadiance, radiance);
UPDATE_ARRAY(float, kMergeDepth, depth);
layout(push_constant) uniform Push { MergePush push; };
#include "trace/composite.glsl"
#include "trace/layers.glsl"
#include "trace/light_bits.glsl"

const float kEnd = 1e30;  // metres: no interval begins or ends any more

// The sum of all lists' intervals from a position on the ray to where the next interval begins or ends.
struct Stretch {
    float end;    // metres
    float sigma;  // 1/m
    vec3 light;   // Σ σ c
};

// The texel of the next interval of the same list, or 0 at its end.
uint interval_after(uint at) {
    const uint next = pages[at - at % kPageWords].x;
    if ((next & kLastPage) == 0u) return at % kPageWords < kPageIntervals ? at + 1u : next * kPageWords + 1u;
    return at % kPageWords < (next & ~kLastPage) ? at + 1u : 0u;
}

// Adds the list's interval at `begin` metres to the stretch; moves the list's cursor (header.w) over an interval that
// has ended.
void add_list(uint list, float begin, inout Stretch stretch) {
    const uvec4 header = pages[list * kPageWords];
    uint at = header.w;
    if (at == 0u) return;
    if (uintBitsToFloat(pages[at].y) <= begin) {
        at = interval_after(at);
        pages[list * kPageWords].w = at;
        if (at == 0u) return;
    }
    const uvec4 interval = pages[at];
    const float t_in = uintBitsToFloat(interval.x);
    if (t_in > begin) {
        stretch.end = min(stretch.end, t_in);
        return;
    }
    const vec2 first = unpackHalf2x16(interval.z);
    const float t_out = uintBitsToFloat(interval.y), sigma = first.x / (t_out - t_in);
    stretch.end = min(stretch.end, t_out);
    stretch.sigma += sigma;
    stretch.light += sigma * light_of_bits(header.z) * vec3(first.y, unpackHalf2x16(interval.w));
}

void main() {
    const uint tile = push.first_tile + gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (tile >= push.end_tile || texelFetch(covered, int(tile)).x == 0u) return;
    const uint ray = tile * kTilePixels + gl_LocalInvocationID.x;
    const uint first = heads[kFirstHead + ray];
    if (first == 0u) return;
    heads[kFirstHead + ray] = 0u;
    Composite sum = composite_begin();
    float begin = 0.0;
    while (sum.transmittance >= push.stop) {
        Stretch stretch = Stretch(kEnd, 0.0, vec3(0.0));
        for (uint list = first; list != 0u; list = pages[list * kPageWords].y) add_list(list, begin, stretch);
        if (stretch.end == kEnd) break;
        if (stretch.sigma > 0.0)
            composite_add(sum, stretch.sigma, stretch.end - begin, stretch.light / stretch.sigma,
                          0.5 * (begin + stretch.end));
        begin = stretch.end;
    }
    const float alpha = 1.0 - sum.transmittance;
    if (alpha > 0.0) store_under(int(ray), vec4(sum.colour, alpha), sum.depth / alpha);
}

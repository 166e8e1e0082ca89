// Pick: for each ray the leaf of a slice tree in which its transmittance T falls to a threshold, and the distance where
// it does: T exp(−σ s) = T_threshold after s metres inside the leaf (errata 14). With kWithColour also the colour down
// to there, Σ ΔT c / (1 − T_threshold), in linear light.
// Reads nodes and first entries, with colour all entries of leaves; writes a Pick per ray. One thread per ray. Bound by
// the walk: two dependent fetches per node, one per sample.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/pick.h"

layout(local_size_x = kPickGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
layout(constant_id = 3) const bool kWithColour = false;
layout(constant_id = 4) const bool kSrgbColours = false;  // summed as such, as trace_rays.glsl does
const bool kShaded = false, kColourless = !kWithColour;
READ_ARRAY(uint, kPickLinks, tree_links);
READ_ARRAY(uvec4, kPickNodes, nodes);
READ_ARRAY(uvec2, kPickEntries, entries);
READ_ARRAY(uint, kPickLeaves, entry_leaf);
READ_ARRAY(vec4, kPickRays, rays);
WRITE_ARRAY(uvec4, kPickOut, picks);
layout(push_constant) uniform Push { PickPush push; };
#include "srgb.glsl"
#include "trace/tree_sample.glsl"

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint ray = group * kPickGroup + gl_LocalInvocationID.x;
    if (ray >= push.rays) return;
    const vec3 origin = FETCH(rays, int(2u * ray)).xyz, direction = FETCH(rays, int(2u * ray + 1u)).xyz;
    sample_begin(direction, 0u);
    const float threshold = push.box_min.w;
    float left = -log(threshold);  // the optical depth that is still missing
    uvec2 pick = uvec2(kNoLeaf, floatBitsToUint(0.0));
    vec3 colour = vec3(0.0);
    March march = march_begin((origin - push.box_min.xyz) / push.box_size.xyz, direction / push.box_size.xyz,
                              vec2(0.0, 1e30));
    MarchInterval part;
    while (left > 0.0 && march_enter(march))
        while (left > 0.0 && march_leaf(march, part)) {
            const float depth = sigma * (part.t_out - part.t_in);
            if (depth >= left) {
                const uint leaf = FETCH(entry_leaf, int(entry / sh_count(kHhDegree))).x;
                pick = uvec2(leaf, floatBitsToUint(part.t_in + left / sigma));
            }
            if (kWithColour) colour += sample_colour() * (threshold * exp(left)) * (1.0 - exp(-min(depth, left)));
            left -= depth;
        }
    colour /= 1.0 - threshold;
    if (kSrgbColours) colour = srgb_decode(colour);
    STORE(picks, int(ray), uvec4(pick, packHalf2x16(colour.rg), packHalf2x16(vec2(colour.b, 0.0))));
}

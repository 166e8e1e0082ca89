// Bind bones: the bone of each entry of a slice tree, which is the one whose surface is nearest to the leaf's centre.
// Reads the leaves of entries and their positions; writes a byte per entry. One thread for four entries, dispatched
// indirectly once a slice. Bound by arithmetic: about 20 operations per entry and bone.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/highlight.h"
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(binding = kBindBones, std140) uniform Bones { ShaderBones body; };
READ_ARRAY(uint, kBindLeaves, entry_leaf);
READ_ARRAY(uvec2, kBindPositions, leaf_positions);
layout(binding = kBindCount, std430) readonly buffer Count { LiveCount counts[]; };
WRITE_ARRAY(uint, kBindOut, entry_bones);
layout(push_constant) uniform Push { BindBonesPush push; };
#include "slice/leaf_centre.glsl"

// How far a point lies outside of a bone, metres; negative: inside.
float distance_to(ShaderBone bone, vec3 point) {
    const vec3 line = bone.to.xyz - bone.from.xyz, to_point = point - bone.from.xyz;
    const float along = clamp(dot(to_point, line) / max(dot(line, line), 1e-12), 0.0, 1.0);
    return length(to_point - along * line) - bone.from.w;
}

uint nearest_bone(vec3 point) {
    uint nearest = kNoBone;
    float least = 1e30;
    for (uint bone = 0u; bone < push.bones; ++bone) {
        const float distance = distance_to(body.bones[bone], point);
        if (distance < least) {
            least = distance;
            nearest = bone;
        }
    }
    return nearest;
}

void main() {
    const uint slots = min(counts[push.slice].slots, push.capacity), word = gl_GlobalInvocationID.x;
    if (4u * word >= slots) return;
    uint bones = 0u;
    for (uint i = 0u; i < 4u; ++i) {
        const uint entry = 4u * word + i;
        const uint leaf = entry < slots ? FETCH(entry_leaf, int(push.slice * push.capacity + entry)).x : kNoLeaf;
        uint bone = kNoBone;
        if (leaf != kNoLeaf)
            bone = nearest_bone(leaf_centre(FETCH(leaf_positions, int(leaf)).xy, push.box_min.xyz, push.box_size.xyz));
        bones |= bone << 8u * i;
    }
    STORE(entry_bones, int(push.slice * push.bone_words + word), uvec4(bones));
}

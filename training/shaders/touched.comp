// Lists the slots that rays touched in this step. One thread per live slot; reads 4 bytes. Without the
// list, lanes of the expensive passes after it would idle at slots that no ray touched.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kSliceGroup) in;
layout(binding = kTouchedMaxWeight, std430) readonly buffer MaxWeight { uint max_weight[]; };
layout(binding = kTouchedLive, std430) readonly buffer Live { LiveCount live; };
WRITE_ARRAY(uint, kTouchedSlots, touched_slots);
layout(binding = kTouchedCount, std430) buffer Count { LiveCount count; };

shared uint group_count;
shared uint group_first;

void main() {
    const uint slot = gl_GlobalInvocationID.x;
    if (gl_LocalInvocationID.x == 0u) group_count = 0u;
    barrier();
    const bool touched = slot < min(live.slots, uint(max_weight.length())) && max_weight[slot] != 0u;
    const uint index_in_group = touched ? atomicAdd(group_count, 1u) : 0u;
    barrier();
    if (gl_LocalInvocationID.x == 0u && group_count > 0u) {
        group_first = atomicAdd(count.slots, group_count);
        atomicMax(count.groups_x, (group_first + group_count + kSliceGroup - 1u) / kSliceGroup);
    }
    barrier();
    if (touched) STORE(touched_slots, int(group_first + index_in_group), uvec4(slot));
}

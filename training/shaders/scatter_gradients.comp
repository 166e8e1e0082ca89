// Where several processes train a tree together: gives the slots of this device the sums of all processes' gradients,
// and lists these slots as touched. Records of leaves that are not live here are left out. One thread per record. Bound
// by memory: each record is read and written once.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/training.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(binding = kRecordsTouched, r32ui) writeonly uniform uimageBuffer touched_slots;
layout(binding = kRecordsCount, std430) buffer Count { LiveCount count; };
layout(binding = kRecordsHead) uniform utextureBuffer head;
layout(binding = kRecordsGradients, std430) writeonly buffer Gradients { float gradients[]; };
layout(binding = kRecordsMaxWeight, std430) writeonly buffer MaxWeight { uint max_weight[]; };
layout(binding = kRecords, std430) readonly buffer Records { uint records[]; };
layout(push_constant) uniform Push { ScatterPush push; };

void main() {
    if (gl_GlobalInvocationID.x >= push.records) return;
    const uint from = gl_GlobalInvocationID.x * record_words(kHhDegree);
    const uvec2 sigma_and_slot = texelFetch(head, int(records[from])).xy;
    if (sigma_and_slot.x == 0u) return;
    const uint slot = sigma_and_slot.y, to = slot * gradient_stride(kHhDegree);
    const uint at = atomicAdd(count.slots, 1u);
    atomicMax(count.groups_x, at / kSliceGroup + 1u);
    imageStore(touched_slots, int(at), uvec4(slot));
    max_weight[slot] = records[from + 1u];
    for (uint i = 0u; i < gradient_stride(kHhDegree); i++) gradients[to + i] = uintBitsToFloat(records[from + 2u + i]);
}

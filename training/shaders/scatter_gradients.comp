// Where several processes train a tree together: gives the slots of this device the sums of all processes' gradients,
// and lists these slots as touched, in the order of the records, so that all processes go on in the same order.
// Rounding that differs between devices can make a leaf empty on one of them alone: kNoSlot stands for it there. One
// thread per record. Bound by reading the records, which lie in the host's memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
WRITE_ARRAY(uint, kRecordsTouched, touched_slots);
READ_ARRAY(uvec2, kRecordsHead, head);
layout(binding = kRecordsGradients, std430) writeonly buffer Gradients { float gradients[]; };
layout(binding = kRecordsMaxWeight, std430) writeonly buffer MaxWeight { uint max_weight[]; };
layout(binding = kRecords, std430) readonly buffer Records { uint records[]; };
layout(push_constant) uniform Push { ScatterPush push; };

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint record = group * kSliceGroup + gl_LocalInvocationID.x;
    if (record >= push.records) return;
    const uint from = record * record_words(kHhDegree);
    const uvec2 sigma_and_slot = FETCH(head, int(records[from])).xy;
    const bool lives = sigma_and_slot.x != 0u;
    STORE(touched_slots, int(record), uvec4(lives ? sigma_and_slot.y : kNoSlot));
    if (!lives) return;
    const uint slot = sigma_and_slot.y, to = slot * gradient_stride(kHhDegree);
    max_weight[slot] = records[from + 1u];
    for (uint i = 0u; i < gradient_stride(kHhDegree); ++i) gradients[to + i] = uintBitsToFloat(records[from + 2u + i]);
}

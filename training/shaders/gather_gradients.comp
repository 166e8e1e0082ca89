// Where several processes train a tree together: writes the gradients of the slots that this process's rays touched as
// records (shared/training.h), which the host sends to the others. One thread per touched slot, dispatched indirectly.
// Bound by writing the records, which lie in the host's memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
READ_ARRAY(uint, kRecordsTouched, touched_slots);
layout(binding = kRecordsCount, std430) readonly buffer Count { LiveCount count; };
READ_ARRAY(uint, kRecordsLeaves, slot_leaf);
layout(binding = kRecordsGradients, std430) readonly buffer Gradients { float gradients[]; };
layout(binding = kRecordsMaxWeight, std430) readonly buffer MaxWeight { uint max_weight[]; };
layout(binding = kRecords, std430) writeonly buffer Records { uint records[]; };

void main() {
    if (gl_GlobalInvocationID.x >= count.slots) return;
    const uint slot = FETCH(touched_slots, int(gl_GlobalInvocationID.x)).x;
    const uint to = gl_GlobalInvocationID.x * record_words(kHhDegree);
    const uint from = slot * gradient_stride(kHhDegree);
    if (to + record_words(kHhDegree) > records.length()) return;  // the host sees that there are too many
    records[to] = FETCH(slot_leaf, int(slot)).x;
    records[to + 1u] = max_weight[slot];
    for (uint i = 0u; i < gradient_stride(kHhDegree); ++i)
        records[to + 2u + i] = floatBitsToUint(gradients[from + i]);
}

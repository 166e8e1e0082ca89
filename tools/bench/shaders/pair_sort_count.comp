// Pair sort, first of three passes: counts how many pairs of each block have each digit.
// Reads the keys of a block; writes the block's counts, and adds them to those of all blocks. One workgroup per block,
// dispatched indirectly. Bound by memory, 8 bytes per pair, and by atomic additions in shared memory where many keys
// have the same digit.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/field.h"
#include "shared/pair_sort.h"

layout(local_size_x = kSortGroup) in;
layout(binding = kSortKeys) uniform utextureBuffer keys;
layout(binding = kSortCount, std430) readonly buffer Count { LiveCount count; };
layout(binding = kSortBlockCounts, std430) writeonly buffer BlockCounts { uint block_counts[]; };
layout(binding = kSortDigitCounts, std430) buffer DigitCounts { uint digit_counts[]; };
layout(push_constant) uniform Push { PairSortPush push; };
#include "pair_sort.glsl"

shared uint counts[kSortDigits];

void main() {
    const uint thread = gl_LocalInvocationID.x, block = gl_WorkGroupID.x;
    counts[thread] = 0u;
    barrier();
    const uint end = min((block + 1u) * kSortBlock, sort_pairs());
    for (uint at = block * kSortBlock + thread; at < end; at += kSortGroup)
        atomicAdd(counts[sort_digit(texelFetch(keys, int(at)).xy)], 1u);
    barrier();
    block_counts[thread * push.stride + block] = counts[thread];
    if (counts[thread] > 0u) atomicAdd(digit_counts[push.round * kSortDigits + thread], counts[thread]);
}

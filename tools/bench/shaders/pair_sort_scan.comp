// Pair sort, second of three passes: computes where the pairs of each block and digit go, which is behind the pairs of
// all lower digits, and behind those of the same digit in earlier blocks. Reads and writes the counts of blocks. One
// workgroup per digit. Bound by barriers: 14 for each 64 blocks.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/field.h"
#include "shared/pair_sort.h"

layout(local_size_x = kSortGroup) in;
layout(binding = kSortCount, std430) readonly buffer Count { LiveCount count; };
layout(binding = kSortBlockCounts, std430) buffer BlockCounts { uint block_counts[]; };
layout(binding = kSortDigitCounts, std430) readonly buffer DigitCounts { uint digit_counts[]; };
layout(push_constant) uniform Push { PairSortPush push; };
#include "pair_sort.glsl"

shared uint sums[kSortGroup];

// The sum of the values of this thread and of those before it; `total` is the sum of all threads.
uint inclusive_sum(uint value, out uint total) {
    const uint thread = gl_LocalInvocationID.x;
    sums[thread] = value;
    barrier();
    for (uint step = 1u; step < kSortGroup; step *= 2u) {
        const uint before = thread >= step ? sums[thread - step] : 0u;
        barrier();
        sums[thread] += before;
        barrier();
    }
    const uint sum = sums[thread];
    total = sums[kSortGroup - 1u];
    barrier();
    return sum;
}

void main() {
    const uint thread = gl_LocalInvocationID.x, digit = gl_WorkGroupID.x, blocks = sort_blocks();
    uint first;
    inclusive_sum(thread < digit ? digit_counts[push.round * kSortDigits + thread] : 0u, first);
    for (uint begin = 0u; begin < blocks; begin += kSortGroup) {
        const uint block = begin + thread, at = digit * push.stride + block;
        const uint own = block < blocks ? block_counts[at] : 0u;
        uint total;
        const uint sum = inclusive_sum(own, total);
        if (block < blocks) block_counts[at] = first + sum - own;
        first += total;
    }
}

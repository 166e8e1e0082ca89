// Pair sort, third of three passes: writes every pair to its position in the order of one digit. Pairs of the same
// digit keep their order. Reads and writes the pairs, and reads where the pairs of each digit go. One workgroup per
// block, dispatched indirectly, 64 consecutive pairs at a time, one per thread: each thread sets its bit among those of
// its digit, and counts the bits before its own, so that the size of a subgroup does not matter. Bound by memory, 24
// bytes per pair with scattered writes, and by shared memory and barriers.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/field.h"
#include "shared/pair_sort.h"

layout(local_size_x = kSortGroup) in;
layout(binding = kSortKeys) uniform utextureBuffer keys;
layout(binding = kSortValues) uniform utextureBuffer values;
layout(binding = kSortCount, std430) readonly buffer Count { LiveCount count; };
layout(binding = kSortBlockCounts, std430) readonly buffer BlockCounts { uint block_counts[]; };
layout(binding = kSortKeysOut, rg32ui) writeonly uniform uimageBuffer keys_out;
layout(binding = kSortValuesOut, r32ui) writeonly uniform uimageBuffer values_out;
layout(push_constant) uniform Push { PairSortPush push; };
#include "pair_sort.glsl"

const uint kWords = kSortGroup / 32u;
// Twice, in turn: for the 64 pairs at hand and for the next ones.
shared uint same[2u][kWords][kSortDigits];  // bit i of word w of a digit: thread 32w + i has the digit
shared uint next[2u][kSortDigits];          // where the next pair of a digit goes

// Pairs of this digit among the threads before this one.
uint rank_of(uint digit, uint turn) {
    const uint thread = gl_LocalInvocationID.x, word = thread / 32u;
    uint rank = bitCount(same[turn][word][digit] & ((1u << (thread & 31u)) - 1u));
    for (uint w = 0u; w < word; ++w) rank += bitCount(same[turn][w][digit]);
    return rank;
}

// Prepares the next turn for the digit that has the thread's number.
void prepare_digit(uint turn) {
    const uint digit = gl_LocalInvocationID.x;
    uint pairs = 0u;
    for (uint w = 0u; w < kWords; ++w) {
        pairs += bitCount(same[turn][w][digit]);
        same[turn ^ 1u][w][digit] = 0u;
    }
    next[turn ^ 1u][digit] = next[turn][digit] + pairs;
}

void main() {
    const uint thread = gl_LocalInvocationID.x, block = gl_WorkGroupID.x;
    next[0][thread] = block_counts[thread * push.stride + block];
    for (uint w = 0u; w < kWords; ++w) same[0][w][thread] = 0u;
    barrier();
    const uint end = min((block + 1u) * kSortBlock, sort_pairs());
    uint turn = 0u;
    for (uint begin = block * kSortBlock; begin < end; begin += kSortGroup, turn ^= 1u) {
        const uint at = begin + thread;
        const uvec2 key = at < end ? texelFetch(keys, int(at)).xy : uvec2(0u);
        const uint digit = sort_digit(key);
        if (at < end) atomicOr(same[turn][thread / 32u][digit], 1u << (thread & 31u));
        barrier();
        if (at < end) {
            const int to = int(next[turn][digit] + rank_of(digit, turn));
            imageStore(keys_out, to, uvec4(key, 0u, 0u));
            imageStore(values_out, to, texelFetch(values, int(at)));
        }
        prepare_digit(turn);
        barrier();
    }
}

// What the passes of the sort (shared/pair_sort.h) share. The file that includes this one binds `count` and declares a
// PairSortPush `push`.
#ifndef NEUVV_PAIR_SORT_GLSL
#define NEUVV_PAIR_SORT_GLSL

uint sort_pairs() { return min(count.slots, push.capacity); }

uint sort_blocks() { return (sort_pairs() + kSortBlock - 1u) / kSortBlock; }

uint sort_digit(uvec2 key) {
    const uint shift = kSortDigitBits * push.round;
    uint bits = shift < 32u ? key.x >> shift : key.y >> (shift & 31u);
    if (shift < 32u && shift + kSortDigitBits > 32u) bits |= key.y << (32u - shift & 31u);
    return bits & (kSortDigits - 1u);
}

#endif

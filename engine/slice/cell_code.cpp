#include "slice/cell_code.h"

namespace neuvv::slice {

namespace {

// Moves bit i of a coordinate to bit 3i.
uint64_t spread_bits(uint32_t coordinate) {
    uint64_t bits = coordinate & 0xfff;
    bits = (bits | bits << 16) & 0x0000ff0000ffull;
    bits = (bits | bits << 8) & 0x00f00f00f00full;
    bits = (bits | bits << 4) & 0x0c30c30c30c3ull;
    bits = (bits | bits << 2) & 0x249249249249ull;
    return bits;
}

// The inverse; other bits are ignored.
uint32_t joined_bits(uint64_t bits) {
    bits &= 0x249249249249ull;
    bits = (bits | bits >> 2) & 0x0c30c30c30c3ull;
    bits = (bits | bits >> 4) & 0x00f00f00f00full;
    bits = (bits | bits >> 8) & 0x0000ff0000ffull;
    bits = (bits | bits >> 16) & 0x000000000fffull;
    return static_cast<uint32_t>(bits);
}

}  // namespace

uint64_t code_of(glm::uvec3 cell) {
    return spread_bits(cell.x) | spread_bits(cell.y) << 1 | spread_bits(cell.z) << 2;
}

glm::uvec3 cell_of(uint64_t code) {
    return {joined_bits(code), joined_bits(code >> 1), joined_bits(code >> 2)};
}

}  // namespace neuvv::slice

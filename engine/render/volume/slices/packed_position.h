// Where nodes and leaves lie, as shaders read it: x | y << 16, z | depth << 16, in cells of their own size.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace neuvv::render {

inline glm::uvec2 packed_position(glm::uvec3 at, uint32_t depth) {
    return {at.x | at.y << 16, at.z | depth << 16};
}
inline glm::uvec3 unpacked_position(glm::uvec2 position) {
    return {position.x & 0xffff, position.x >> 16, position.y & 0xffff};
}

// The corner of an octant of a cell, in octants.
inline glm::uvec3 octant_offset(uint32_t octant) {
    return {octant & 1, octant >> 1 & 1, octant >> 2};
}

}  // namespace neuvv::render

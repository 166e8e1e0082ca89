// Morton codes: where a cell lies among those of its depth, as one number. The codes of a depth are in the order in
// which a walk over the octree meets its cells.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace neuvv::slice {

// Bit i of x, y and z is bit 3i, 3i + 1 and 3i + 2 of the code. Coordinates have at most 12 bits; higher ones are
// ignored.
uint64_t code_of(glm::uvec3 cell);
glm::uvec3 cell_of(uint64_t code);

}  // namespace neuvv::slice

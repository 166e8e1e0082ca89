// Slices with fewer or larger leaves that show about the same.
#pragma once

#include <cstddef>
#include <cstdint>

#include "slice/slice.h"

namespace neuvv::slice {

// The same slice with at most `most_leaves` leaves, or eight where that is less: cells of the finest depth become one,
// those first of which images show least difference. What they hide and show together stays about the same.
Slice with_fewer_leaves(Slice slice, size_t most_leaves);

// The same slice without leaves below a depth, which becomes its finest.
Slice with_depth(Slice slice, uint32_t most_depth);

}  // namespace neuvv::slice

// The entries of a slice tree (shared/slice_tree.h), made on the host of a slice's whole numbers.
#pragma once

#include "render/volume/slices/slice_layout.h"

namespace neuvv::render {

// `to`: 2 · sh_count(degree) words for each of layout.entries entries, and one for each; they are written in any order,
// and not read. `box_size`: of the slice, metres.
void write_entries(const stream::QuantisedSlice& slice, const SliceLayout& layout, glm::vec3 box_size, glm::uvec2* to);
void write_entry_leaves(const stream::QuantisedSlice& slice, const SliceLayout& layout, uint32_t* to);

}  // namespace neuvv::render

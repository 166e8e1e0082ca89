// The straight path: the slice of a stream's frame goes to the device as the slice tree that rays walk. There are no
// weights, and nothing is sliced.
#pragma once

#include <optional>

#include "render/volume/slices/dequantise.h"

namespace neuvv::render {

// What it takes on the device for each leaf, with about as many nodes as surfaces have.
constexpr uint64_t slice_bytes_per_leaf(uint32_t degree) {
    return (4 * kEntryWords * sh_count(degree) + 12) * 9 / 8;
}

// The slice, as a decoder returns it, in a box in metres: a field of one frame with Field::slice and without weights.
// It can be drawn and picked in, but neither painted, nor drawn by the direct path. Leaves without opacity are left
// out. `by`: what makes the entries; the usual one without. Throws RuntimeFailure where the device lacks memory or a
// limit is exceeded.
Field upload_slice(const gpu::Device& device, const stream::QuantisedSlice& slice, glm::vec3 box_min,
                   glm::vec3 box_size, std::optional<Dequantiser> by = {});

}  // namespace neuvv::render

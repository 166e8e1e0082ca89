// Slices as the whole numbers that a stream has of them, and back (stream/README.md, "Planes").
#pragma once

#include <glm/glm.hpp>

#include "slice/curves.h"
#include "slice/slice.h"
#include "stream/codec/quantised_slice.h"

namespace neuvv::slice {

// Less opacity along the edge of a leaf is 0 in whole numbers.
constexpr float kLeastOpacity = 0.5f / stream::kUnit;

// It has the same leaves, of which those below kLeastOpacity get an opacity of 0.
stream::QuantisedSlice quantised(const Slice& slice);

// `box_min`, `box_size`: metres. Opacities must be 0 to stream::kUnit.
Slice values_of(const stream::QuantisedSlice& slice, glm::vec3 box_min, glm::vec3 box_size);

}  // namespace neuvv::slice

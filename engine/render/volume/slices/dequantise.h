// The pass that makes a slice's entries on the device of the slice's whole numbers.
#pragma once

#include "render/volume/slices/slice_layout.h"
#include "render/volume/slices/slice_tree.h"

namespace neuvv::render {

// Where a slice's numbers become σ and SH coefficients in fp16: both ways give the same, up to how fp16 is rounded.
enum class Dequantiser { kHost, kDevice };

// The device where it is a graphics card with memory of its own, because the card gets fewer bytes over the bus than
// entries have. Other devices share the host's memory or are its processor. `neuvv-bench stream` measures both ways.
Dequantiser usual_dequantiser(const gpu::Device& device);

// Writes the entries, and the leaves of entries, of a slice. `to` has room for those of the layout, and
// `leaf_positions` are on the device. Waits for the device, whose main queue it uses. Throws RuntimeFailure where the
// device lacks memory or dispatches fewer threads.
void dequantise(const gpu::Device& device, const stream::QuantisedSlice& slice, const SliceLayout& layout,
                glm::vec3 box_size, const gpu::Buffer& leaf_positions, const SliceBuffers& to);

}  // namespace neuvv::render

// The pass that makes a slice's entries on the device of the slice's whole numbers.
#pragma once

#include "render/volume/slices/slice_layout.h"
#include "render/volume/slices/slice_tree.h"

namespace neuvv::render {

// Where a slice's numbers become σ and SH coefficients in fp16: both ways give the same, up to how fp16 is rounded.
enum class Dequantiser { kHost, kDevice };

// Of 500,000 leaves of degree 1 the host takes 9 ms of a core, and a device that is the host's own processor takes 25,
// so there it is the host. A graphics card reads and writes 37 MB for them, which is 0.1 ms, and gets 3 MB less over
// the bus: counted, and not measured yet. Other devices share the host's memory, and keep to the host.
Dequantiser usual_dequantiser(const gpu::Device& device);

// Writes the entries, and the leaves of entries, of a slice. `to` has room for those of the layout, and
// `leaf_positions` are on the device. Waits for the device; to be called by threads that do not draw. Throws
// RuntimeFailure where the device lacks memory or dispatches fewer threads.
void dequantise(const gpu::Device& device, const stream::QuantisedSlice& slice, const SliceLayout& layout,
                glm::vec3 box_size, const gpu::Buffer& leaf_positions, const SliceBuffers& to);

}  // namespace neuvv::render

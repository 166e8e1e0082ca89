// Shade: one colour for each leaf of a slice tree, as it looks from one eye.
#pragma once

#include "render/volume/slices/slice_tree.h"

namespace neuvv::render {

struct Shader {
    // All arguments must outlive it. `shaded` has room for the entries of one slice for each view (shaded_entries).
    Shader(const gpu::Device& device, const Field& field, const SliceTrees& trees, const gpu::Buffer& shaded);

    const Field& field;
    const SliceTrees& trees;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// A buffer for `capacity` shaded entries (8 bytes each) for each view.
gpu::Buffer shaded_entries(const gpu::Device& device, uint32_t capacity, uint32_t views = 1);

// `eye` is the position of the view's camera, in the performer's space, metres.
void record_shade(gpu::Commands& commands, const Shader& shader, uint32_t slice, uint32_t view, glm::vec3 eye);

}  // namespace neuvv::render

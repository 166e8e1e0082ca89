// Shade: a slice tree as seen from one eye, one colour a leaf.
#pragma once

#include "render/slice_tree.h"

namespace neuvv::render {

struct Shader {
    // All must outlive it. `shaded` has room for the entries of one slice from each view (shaded_entries).
    Shader(const gpu::Device& device, const Field& field, const SliceTrees& trees, const gpu::Buffer& shaded);

    const Field& field;
    const SliceTrees& trees;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// A buffer for the shaded entries of a slice with room for so many, from each view.
gpu::Buffer shaded_entries(const gpu::Device& device, uint32_t capacity, uint32_t views = 1);

// `eye`: the view's, in the performer's space, metres.
void record_shade(gpu::Commands& commands, const Shader& shader, uint32_t slice, uint32_t view, glm::vec3 eye);

}  // namespace neuvv::render

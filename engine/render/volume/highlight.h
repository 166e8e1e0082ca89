// Highlight: parts of one instance in red. The leaves of a slice are bound to bones once, the shaded entries of an
// instance are tinted for each view, so that other instances of the slice keep their colours.
#pragma once

#include <array>
#include <span>

#include "render/volume/slices/slice_tree.h"
#include "shared/highlight.h"

namespace neuvv::render {

// A line with a thickness, in the performer's space, metres.
struct Bone {
    glm::vec3 from{0}, to{0};
    float radius = 0;
    bool operator==(const Bone&) const = default;
};

// A leaf belongs to the bone whose surface is nearest to its centre; of several to the first.
struct Highlight {
    std::vector<Bone> bones;   // at the instance's time; at most kMaxBones
    std::vector<float> tints;  // 0..1 of each bone: how red it is
    bool operator==(const Highlight&) const = default;
};

// Binds the leaves of slices to bones.
struct BoneBinder {
    // Field and trees must outlive it.
    BoneBinder(const gpu::Device& device, const Field& field, const SliceTrees& trees);

    const Field& field;
    const SliceTrees& trees;
    uint32_t bone_words;             // of a slice in entry_bones
    gpu::Buffer bones, entry_bones;  // ShaderBones; a byte per entry
    gpu::ComputePass pass;
    gpu::BindingSet set;
    struct Bound {
        uint64_t build = 0;  // of the slice (SliceCache::build_of)
        std::vector<Bone> bones;
        bool operator==(const Bound&) const = default;
    };
    std::vector<Bound> bound;  // by slice
};

// Binds a slice to the bones unless it is bound to them already.
void record_bind_bones(gpu::Commands& commands, BoneBinder& binder, uint32_t slice, uint64_t build,
                       std::span<const Bone> bones);

struct Highlighter {
    // The binder and the shaded entries must outlive it.
    Highlighter(const gpu::Device& device, const BoneBinder& binder, const gpu::Buffer& shaded);

    const BoneBinder& binder;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Tints the shaded entries of a view. To be recorded after record_shade.
void record_highlight(gpu::Commands& commands, const Highlighter& highlighter, uint32_t slice, uint32_t view,
                      std::span<const float> tints);

}  // namespace neuvv::render

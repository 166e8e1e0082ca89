#include "render/volume/slices/slice_entries.h"

#include <algorithm>
#include <array>

#include "base/threads/parallel.h"
#include "base/vector_clones.h"
#include "shared/slice_tree.h"
#include "slice/curves.h"
#include "voctree/files/half.h"

namespace neuvv::render {

namespace {

constexpr size_t kLeavesOfPart = 8192;

// σ of leaves in 1/m as fp16, by their depth in the slice and their opacity.
class SigmaHalves {
  public:
    SigmaHalves(uint32_t depth, glm::vec3 box_size) {
        for (const float sigma : slice::sigmas_of(depth, box_size)) halves_.push_back(voctree::half_from_float(sigma));
    }
    uint16_t of(uint32_t depth, int16_t opacity) const {
        return halves_[depth * slice::kOpacities + static_cast<size_t>(opacity)];
    }

  private:
    std::vector<uint16_t> halves_;
};

// The coefficients k_00 of slice::colour_curves() as fp16.
const std::array<uint16_t, slice::kColourHalves>& constant_halves() {
    static const std::array kHalves = [] {
        std::array<uint16_t, slice::kColourHalves> halves;
        for (size_t i = 0; i < halves.size(); ++i)
            halves[i] = voctree::half_from_float(slice::colour_curves().constant[i]);
        return halves;
    }();
    return kHalves;
}

// Writes the entries of leaves, in blocks whose numbers are computed plane by plane, which compilers vectorise.
class EntryWriter {
  public:
    // `to`: all entries; they are not read.
    EntryWriter(const stream::QuantisedSlice& slice, const SliceLayout& layout, const SigmaHalves& sigma,
                glm::uvec2* to)
        : slice_(slice), layout_(layout), sigma_(sigma), functions_(sh_count(slice.degree)), to_(to) {}

    // Of the leaves begin…end−1.
    void write(size_t begin, size_t end) {
        for (; begin < end; begin += kBlock) write_block(begin, std::min(kBlock, end - begin));
    }

  private:
    static constexpr size_t kBlock = 512;
    using Floats = std::array<float, kBlock>;
    using Halves = std::array<uint16_t, kBlock>;

    NEUVV_VECTOR_CLONES void write_block(size_t first, size_t count) {
        for (uint32_t harmonic = 0; harmonic < functions_; ++harmonic) {
            read_colours(harmonic, first, count);
            harmonic == 0 ? mean_coefficients(count) : coefficients(harmonic, count);
            glm::uvec2* words = &words_[harmonic * kBlock];
            const uint16_t *r = halves_[0].data(), *g = halves_[1].data(), *b = halves_[2].data();
            for (size_t i = 0; i < count; ++i) words[i] = {uint32_t{r[i]} << 16, g[i] | uint32_t{b[i]} << 16};
        }
        const int16_t* opacity = &slice_.planes[stream::kOpacityPlane][first];
        const uint32_t* entries = &layout_.entry_of_leaf[first];
        const stream::Leaf* leaves = &slice_.leaves[first];
        for (size_t i = 0; i < count; ++i) {
            if (entries[i] == kNoLeaf) continue;
            const size_t entry = layout_.entry_of(leaves[i].depth, entries[i]);
            glm::uvec2* to = to_ + entry * functions_;
            const glm::uvec2* from = &words_[i];
            *to = {from->x | sigma_.of(leaves[i].depth, opacity[i]), from->y};
            for (uint32_t harmonic = 1; harmonic < functions_; ++harmonic) to[harmonic] = from[harmonic * kBlock];
        }
    }

    // Pointers here, so that no access in the loops checks its index.
    void read_colours(uint32_t harmonic, size_t first, size_t count) {
        const auto* planes = &slice_.planes[stream::kFirstColourPlane + 3 * harmonic];
        const int16_t *y = &planes[0][first], *co = &planes[1][first], *cg = &planes[2][first];
        float *r = shown_[0].data(), *g = shown_[1].data(), *b = shown_[2].data();
        for (size_t i = 0; i < count; ++i) {
            const stream::Rgb rgb =
                stream::rgb_of({static_cast<float>(y[i]), static_cast<float>(co[i]), static_cast<float>(cg[i])});
            r[i] = rgb.r;
            g[i] = rgb.g;
            b[i] = rgb.b;
        }
    }
    void mean_coefficients(size_t count) {
        const uint16_t* of_half = constant_halves().data();
        for (size_t c = 0; c < 3; ++c) {
            const float* shown = shown_[c].data();
            uint16_t *mean = mean_[c].data(), *halves = halves_[c].data();
            for (size_t i = 0; i < count; ++i) mean[i] = slice::colour_half(shown[i]);
            for (size_t i = 0; i < count; ++i) halves[i] = of_half[mean[i]];
        }
    }
    void coefficients(uint32_t harmonic, size_t count) {
        const float* per_unit = slice::colour_curves().per_unit[slice::degree_of_harmonic(harmonic)].data();
        for (size_t c = 0; c < 3; ++c) {
            float* shown = shown_[c].data();
            const uint16_t* mean = mean_[c].data();
            uint16_t* halves = halves_[c].data();
            for (size_t i = 0; i < count; ++i) shown[i] *= per_unit[mean[i]];
            for (size_t i = 0; i < count; ++i) halves[i] = voctree::half_from_float(shown[i]);
        }
    }

    const stream::QuantisedSlice& slice_;
    const SliceLayout& layout_;
    const SigmaHalves& sigma_;
    const uint32_t functions_;
    glm::uvec2* const to_;
    // Of a block:
    std::array<Floats, 3> shown_;
    std::array<Halves, 3> mean_, halves_;
    std::array<glm::uvec2, kMaxShCount * kBlock> words_;  // harmonic after harmonic
};

}  // namespace

void write_entries(const stream::QuantisedSlice& slice, const SliceLayout& layout, glm::vec3 box_size, glm::uvec2* to) {
    const uint32_t functions = sh_count(slice.degree);
    for (const SliceLayout::NodeEntry& one : layout.node_entries) {
        std::fill_n(to + size_t{one.entry} * functions, functions, glm::uvec2(0));
        to[size_t{one.entry} * functions] = {kEntryIsNode, one.node};
    }
    const SigmaHalves sigma(slice.depth, box_size);
    parallel_for(slice.leaves.size(), kLeavesOfPart,
                 [&](size_t begin, size_t end) { EntryWriter(slice, layout, sigma, to).write(begin, end); });
}

void write_entry_leaves(const stream::QuantisedSlice& slice, const SliceLayout& layout, uint32_t* to) {
    for (const SliceLayout::NodeEntry& one : layout.node_entries) to[one.entry] = kNoLeaf;
    for (uint32_t i = 0; i < slice.leaves.size(); ++i)
        if (layout.entry_of_leaf[i] != kNoLeaf) to[layout.entry_of(slice.leaves[i].depth, layout.entry_of_leaf[i])] = i;
}

}  // namespace neuvv::render

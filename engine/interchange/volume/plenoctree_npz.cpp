#include "interchange/volume/plenoctree_npz.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/error.h"
#include "base/formats/npz_writer.h"
#include "base/sigmoid.h"
#include "base/threads/parallel.h"
#include "media/image.h"
#include "voctree/files/half.h"
#include "voctree/sh_weights.h"

namespace neuvv::interchange {

namespace {

constexpr size_t kPlenLeavesOfPart = 1024;
constexpr size_t kMaxPlenNodes = size_t{1} << 27;
constexpr double kLastPlenLogit = 20;  // beyond, sRGB is a straight line of linear light, or nearly 1
constexpr int64_t kSvoxDepthLimit = 10;

// A direction of a quadrature over the sphere, with the harmonics of it in the clip's axes, and svox' in the file's.
struct PlenDirection {
    std::array<double, kMaxShCount> of_clip, of_file;
    double weight;
};

// svox has the Condon-Shortley phase: harmonics of odd m change their sign.
std::vector<PlenDirection> plen_directions() {
    std::vector<PlenDirection> all;
    for (const voctree::ShDirection& from : voctree::sh_directions()) {
        PlenDirection& direction = all.emplace_back();
        direction.weight = from.weight;
        direction.of_clip = voctree::sh_basis(from.d);
        direction.of_file = voctree::sh_basis({from.d.x, -from.d.z, from.d.y});
        for (uint32_t l = 0, i = 0; l * l < kMaxShCount; ++l)
            for (uint32_t m = 0; m <= 2 * l; ++m, ++i)
                if ((m + l) % 2 != 0) direction.of_file[i] = -direction.of_file[i];
    }
    return all;
}

// From the logit of linear light to that of sRGB.
double srgb_logit(double logit) {
    const double clamped = std::clamp(logit, -kLastPlenLogit, kLastPlenLogit);
    const double srgb = media::srgb_from_linear(sigmoid(clamped));
    return std::log(srgb / (1 - srgb)) + (logit - clamped);
}

class PlenTree {
  public:
    PlenTree(const slice::Slice& volume, const std::string& file)
        : volume_(volume), file_(file), numbers_(3 * sh_count(volume.degree) + 1) {
        add_node(0, 0);
        for (const slice::Leaf& leaf : volume.leaves) cells_.push_back(cell_of(leaf));
        data_.resize(child_.size() * numbers_);
        fill();
    }
    std::vector<NpzArray> arrays() const;

  private:
    void add_node(size_t parent_cell, int32_t depth) {
        child_.resize(child_.size() + 8);
        parent_depth_.insert(parent_depth_.end(), {static_cast<int32_t>(parent_cell), depth});
    }
    size_t cell_of(const slice::Leaf& leaf);
    void fill();

    const slice::Slice& volume_;
    const std::string& file_;  // for errors
    size_t numbers_;
    std::vector<int32_t> child_;         // 8 a node: to the node below, relative to the cell's own; 0: a leaf
    std::vector<int32_t> parent_depth_;  // 2 a node
    std::vector<size_t> cells_;          // of the leaves: 8 · node + 4 x + 2 y + z
    std::vector<uint16_t> data_;
};

// The cell of a leaf, with the nodes above it made.
size_t PlenTree::cell_of(const slice::Leaf& leaf) {
    assert(leaf.depth >= 1);
    const voctree::LeafPosition at = voctree::position_of(leaf.cell >> 3 * (volume_.depth - leaf.depth), leaf.depth);
    const uint32_t x = at.x, y = (1u << leaf.depth) - 1 - at.z, z = at.y;  // in the file's axes
    size_t node = 0;
    for (uint32_t depth = 1;; ++depth) {
        const uint32_t shift = leaf.depth - depth;
        const size_t cell = 8 * node + 4 * (x >> shift & 1) + 2 * (y >> shift & 1) + (z >> shift & 1);
        if (depth == leaf.depth) return cell;
        if (child_[cell] == 0) {
            if (child_.size() / 8 >= kMaxPlenNodes)
                throw InputError(file_, "", fmt::format("would have more than {} nodes", kMaxPlenNodes),
                                 "export a clip with fewer leaves");
            child_[cell] = static_cast<int32_t>(child_.size() / 8 - node);
            add_node(cell, static_cast<int32_t>(depth));
        }
        node += static_cast<size_t>(child_[cell]);
    }
}

void PlenTree::fill() {
    const std::vector<PlenDirection> directions = plen_directions();
    const uint32_t count = sh_count(volume_.degree);
    parallel_for(cells_.size(), kPlenLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const slice::Leaf& leaf = volume_.leaves[i];
            uint16_t* numbers = &data_[cells_[i] * numbers_];
            for (size_t c = 0; c < 3; ++c) {
                std::array<double, kMaxShCount> encoded{};
                for (const PlenDirection& direction : directions) {
                    double logit = 0;
                    for (uint32_t k = 0; k < count; ++k)
                        logit += static_cast<double>(leaf.colours[c][k]) * direction.of_clip[k];
                    const double weighted = direction.weight * srgb_logit(logit);
                    for (uint32_t k = 0; k < count; ++k) encoded[k] += weighted * direction.of_file[k];
                }
                for (uint32_t k = 0; k < count; ++k)
                    *numbers++ = voctree::half_from_float(static_cast<float>(encoded[k]));
            }
            *numbers = voctree::half_from_float(std::min(leaf.sigma, voctree::kMaxHalf));
        }
    });
}

std::vector<NpzArray> PlenTree::arrays() const {
    const uint64_t nodes = child_.size() / 8;
    const glm::vec3 &low = volume_.box_min, &size = volume_.box_size;
    // svox maps the world's x to offset + invradius · x, from 0 to 1 in the box.
    const glm::dvec3 file_low(low.x, -(double{low.z} + double{size.z}), low.y), file_size(size.x, size.z, size.y);
    const glm::vec3 invradius(1.0 / file_size), offset(-file_low / file_size);
    const auto vector = [](const char* name, const glm::vec3& v) {
        return npz_array<float>(name, "<f4", {3}, {v.x, v.y, v.z});
    };
    int32_t deepest = 0;
    for (size_t i = 1; i < parent_depth_.size(); i += 2) deepest = std::max(deepest, parent_depth_[i]);
    return {npz_number("data_dim", static_cast<int64_t>(numbers_)),
            npz_array("child", "<i4", {nodes, 2, 2, 2}, child_),
            npz_array("parent_depth", "<i4", {nodes, 2}, parent_depth_),
            npz_number("n_internal", static_cast<int64_t>(nodes)),
            npz_number("n_free", int64_t{0}),
            vector("invradius3", invradius),
            vector("offset", offset),
            npz_number("depth_limit", std::max<int64_t>(kSvoxDepthLimit, deepest + 1)),
            npz_number("geom_resize_fact", 1.0),
            npz_text("data_format", fmt::format("SH{}", sh_count(volume_.degree))),
            npz_array("data", "<f2", {nodes, 2, 2, 2, numbers_}, data_)};
}

}  // namespace

void write_plenoctree(const std::filesystem::path& file, const slice::Slice& volume) {
    write_npz(file, PlenTree(volume, file.string()).arrays());
}

uint64_t plenoctree_bytes(const slice::Slice& volume) {
    constexpr double kPacked = 0.9;  // of the leaves' own numbers, as measured; empty cells pack to nearly nothing
    return static_cast<uint64_t>(kPacked * 2 * static_cast<double>(volume.leaves.size()) *
                                 (3 * sh_count(volume.degree) + 1));
}

}  // namespace neuvv::interchange

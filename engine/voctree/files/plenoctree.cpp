#include "voctree/files/plenoctree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <tuple>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "voctree/decode_colours.h"
#include "voctree/files/half.h"
#include "voctree/files/occupied_box.h"
#include "voctree/files/plenoctree_file.h"
#include "voctree/sh_weights.h"

namespace neuvv::voctree {

namespace {

constexpr uint32_t kMaxDepth = 2 * kMaxNodeLevels;

// From the axes of a clip, +Y up, to those of the file.
glm::dvec3 in_file(glm::dvec3 d, UpAxis up) {
    return up == UpAxis::kZ ? glm::dvec3(d.x, -d.z, d.y) : d;
}

// The box in the axes of a clip.
std::pair<glm::vec3, glm::vec3> turned(const PlenoctreeBox& box, UpAxis up) {
    if (up == UpAxis::kY) return {box.min, box.size};
    return {{box.min.x, box.min.z, -(box.min.y + box.size.y)}, {box.size.x, box.size.z, box.size.y}};
}

// From the numbers of a channel to its SH coefficients: in the clip's axes, and without the Condon-Shortley phase,
// which svox has. A turn by a right angle mixes few coefficients, so only the factors that are not 0 are kept.
class ShTurn {
  public:
    ShTurn(const PlenoctreeFormat& format, UpAxis up) : functions_(sh_count(format.degree)) {
        for (uint32_t l = 0; l <= format.degree; ++l)
            for (uint32_t to = l * l; to < (l + 1) * (l + 1); ++to)
                for (uint32_t from = l * l; from < (l + 1) * (l + 1); ++from) add(to, from, l, format.scale, up);
    }

    // `numbers` and `k` have functions_ elements each.
    void turn(const float* numbers, float* k) const {
        std::fill_n(k, functions_, 0.0f);
        for (const Factor& one : factors_) k[one.to] += one.factor * numbers[one.from];
    }

  private:
    struct Factor {
        uint32_t to, from;
        float factor;
    };
    uint32_t functions_;
    std::vector<Factor> factors_;

    // ∫ Y_to(d) Y_from(in_file(d)) over the sphere, times the phase of Y_from. The quadrature is exact.
    void add(uint32_t to, uint32_t from, uint32_t l, double scale, UpAxis up) {
        double sum = 0;
        for (const ShDirection& one : sh_directions())
            sum += one.weight * sh_basis(one.d)[to] * sh_basis(in_file(one.d, up))[from];
        const uint32_t m_plus_l = from - l * l;
        const double phase = (m_plus_l + l) % 2 == 0 ? 1 : -1;
        if (std::abs(sum) > 1e-9) factors_.push_back({to, from, static_cast<float>(scale * phase * sum)});
    }
};

// The leaves in the order of a VOctree's cells. The walk needs the file's nodes alone.
class LeafWalk {
  public:
    LeafWalk(const PlenoctreeFile& file, UpAxis up) : file_(file), reached_(file.nodes()) {
        for (uint32_t i = 0; i < 8; ++i) {
            const uint32_t x = i & 1, y = i >> 1 & 1, z = i >> 2;
            cell_in_file_[i] = up == UpAxis::kZ ? 4 * x + 2 * (1 - z) + y : 4 * x + 2 * y + z;
        }
        reached_[0] = true;
        visit(0, {0, 0, 0, 0});
    }

    // Drops the leaves of σ ≤ 0. Needs the file's numbers.
    void keep_dense() {
        size_t kept = 0;
        for (size_t i = 0; i < cells.size(); ++i) {
            if (file_.sigma(cells[i]) <= 0) continue;
            deepest = std::max(deepest, positions[i].depth);
            positions[kept] = positions[i];
            cells[kept++] = cells[i];
        }
        positions.resize(kept);
        cells.resize(kept);
        if (kept < positions.capacity() / 2) {  // the most of a large tree may be empty
            positions.shrink_to_fit();
            cells.shrink_to_fit();
        }
        if (kept == 0) throw InputError(file_.name(), "data", "is empty everywhere", "extract the tree anew");
        if (kept > kMaxLeaves)
            throw InputError(file_.name(), "child", fmt::format("has more than {} leaves", kMaxLeaves),
                             "extract a coarser tree");
    }

    std::vector<LeafPosition> positions;
    std::vector<uint64_t> cells;  // of the file
    uint32_t deepest = 1;

  private:
    const PlenoctreeFile& file_;
    uint32_t cell_in_file_[8];   // by the number of a cell of a node in the clip's axes, where z is the highest bit
    std::vector<bool> reached_;  // nodes

    // The recursion is at most kMaxDepth deep, because child_of refuses deeper nodes.
    void visit(uint64_t node, const LeafPosition& position) {
        for (uint32_t i = 0; i < 8; ++i) {
            const uint64_t cell = 8 * node + cell_in_file_[i];
            const LeafPosition at{2 * position.x + (i & 1), 2 * position.y + (i >> 1 & 1), 2 * position.z + (i >> 2),
                                  position.depth + 1};
            if (file_.child(cell) != 0) {
                visit(child_of(node, cell, at.depth), at);
                continue;
            }
            positions.push_back(at);
            cells.push_back(cell);
        }
    }

    uint64_t child_of(uint64_t node, uint64_t cell, uint32_t depth) {
        const auto fail = [&](const std::string& problem, const char* fix = "write it with N3Tree.save of svox") {
            throw InputError(file_.name(), PlenoctreeFile::place("child", cell), problem, fix);
        };
        const int64_t child = static_cast<int64_t>(node) + file_.child(cell);
        if (child < 0 || child >= static_cast<int64_t>(reached_.size()))
            fail(fmt::format("node {} does not exist ({} do)", child, reached_.size()));
        const auto index = static_cast<uint64_t>(child);
        if (reached_[index]) fail(fmt::format("node {} is reached more than once", child));
        if (depth == kMaxDepth)
            fail(fmt::format("leaves lie deeper than {} levels", kMaxDepth), "extract a coarser tree");
        reached_[index] = true;
        return index;
    }
};

void decode(const ColourDecoder& decoder, float* k, uint32_t functions) {
    ChannelSh numbers{};
    std::copy_n(k, functions, numbers.begin());
    numbers = decoder.decode(numbers);
    std::transform(numbers.begin(), numbers.begin() + functions, k, [](double x) { return static_cast<float>(x); });
}

void fill_leaves(VOctree& tree, const PlenoctreeFile& file, const LeafWalk& leaves, PlenoctreeColours colours,
                 UpAxis up) {
    const PlenoctreeFormat& format = file.format();
    const ShTurn turn(format, up);
    const ColourDecoder decoder(format.degree);
    const uint32_t functions = sh_count(format.degree);
    parallel_for(leaves.cells.size(), 4096, [&](size_t begin, size_t end) {
        std::array<float, 3 * kMaxShCount> numbers;
        std::array<float, kMaxShCount> k;
        for (size_t i = begin; i < end; ++i) {
            float* weights = tree.leaf(static_cast<uint32_t>(i));
            *weights = std::min(file.sigma(leaves.cells[i]), kMaxHalf);
            weights += 2;  // γ = π sigmoid(0)
            file.colours(leaves.cells[i], numbers.data());
            for (uint32_t channel = 0; channel < 3; ++channel, weights += hh_count(format.degree)) {
                turn.turn(&numbers[size_t{channel} * format.numbers], k.data());
                if (colours == PlenoctreeColours::kLinear) decode(decoder, k.data(), functions);
                write_sh(weights, format.degree, k.data());
            }
        }
    });
}

// The leaves of σ > 0. The file's numbers are unpacked while its nodes are walked over.
LeafWalk read_leaves(PlenoctreeFile& file, UpAxis up) {
    std::future<void> numbers = std::async(std::launch::async, [&] { file.read_numbers(); });
    LeafWalk leaves(file, up);
    numbers.get();
    leaves.keep_dense();
    return leaves;
}

}  // namespace

VOctree read_plenoctree(const std::filesystem::path& path, PlenoctreeColours colours, UpAxis up) {
    PlenoctreeFile file(path);
    const LeafWalk leaves = read_leaves(file, up);
    VOctree tree;
    std::tie(tree.box_min, tree.box_size) = turned(file.box(), up);
    make_still(tree, file.format().degree);
    tree.node_levels = (leaves.deepest + 1) / 2;
    tree.has_srgb_colours = colours == PlenoctreeColours::kAsStored;
    // The weights are filled while the nodes are built, which read nothing of each other.
    std::future<void> nodes = std::async(std::launch::async, [&] { build_nodes(tree, leaves.positions); });
    tree.weights.resize(leaves.cells.size() * tree.weights_per_leaf());
    fill_leaves(tree, file, leaves, colours, up);
    nodes.get();
    if (tree.nodes.size() > kMaxNodes)
        throw InputError(file.name(), "child", fmt::format("needs more than {} nodes", kMaxNodes),
                         "extract a coarser tree");
    return tree;
}

std::pair<glm::vec3, glm::vec3> read_plenoctree_box(const std::filesystem::path& path, UpAxis up) {
    return turned(read_box_of_file(path), up);
}

std::pair<glm::dvec3, glm::dvec3> read_plenoctree_leaf_box(const std::filesystem::path& path, UpAxis up) {
    PlenoctreeFile file(path);
    const auto [box_min, box_size] = turned(file.box(), up);
    return occupied_box(read_leaves(file, up).positions, box_min, box_size);
}

}  // namespace neuvv::voctree

#include "interchange/mesh/solid.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/threads/parallel.h"

namespace neuvv::interchange {

namespace {

// A cell is seen from outside where so many of 26 directions see it. A gap in a wall, through which one direction and
// its opposite go, does not count.
constexpr size_t kThrough = 3;
// The cells within which a ray must get the opacity: a wall is rarely opaque within one.
constexpr float kReach_cells = 2;

// Corner i of a block of 2×2×2 cells.
constexpr glm::ivec3 corner(uint32_t i) {
    return {static_cast<int>(i & 1), static_cast<int>(i >> 1 & 1), static_cast<int>(i >> 2 & 1)};
}

// Whether the boundary of the cells of a block, one bit each, is no manifold at its centre: cells of a face that meet
// in an edge alone, or two opposite corners of the block that are alone.
constexpr bool is_critical(uint32_t block) {
    for (uint32_t axis = 0; axis < 3; ++axis)
        for (uint32_t side = 0; side < 2; ++side) {
            const uint32_t u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, first = side << axis;
            const auto has = [&](uint32_t cell) { return (block >> cell & 1) != 0; };
            const bool a = has(first), b = has(first + u), c = has(first + v), d = has(first + u + v);
            if (a == d && b == c && a != b) return true;
        }
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t pair = 1u << i | 1u << (7 - i);
        if (block == pair || block == (~pair & 0xFFu)) return true;
    }
    return false;
}

constexpr std::array<bool, 256> critical_blocks() {
    std::array<bool, 256> critical{};
    for (uint32_t i = 0; i < 256; ++i) critical[i] = is_critical(i);
    return critical;
}
constexpr std::array<bool, 256> kCritical = critical_blocks();

uint32_t block_at(const Solid& solid, const glm::ivec3& first) {
    uint32_t block = 0;
    for (uint32_t i = 0; i < 8; ++i)
        block |= static_cast<uint32_t>(solid.inside(solid.index_of(first + corner(i)))) << i;
    return block;
}

// The cell of a block that is to be filled: one after which the block is not critical, if there is such a one, and of
// those the most opaque.
glm::ivec3 best_filling(const Solid& solid, const glm::ivec3& first, uint32_t block) {
    uint32_t best = 8;
    float best_rank = -1;
    for (uint32_t i = 0; i < 8; ++i) {
        if ((block >> i & 1) != 0) continue;
        const float rank =
            solid.opacity[solid.index_of(first + corner(i))] + (kCritical[block | 1u << i] ? 0.0f : 2.0f);
        if (rank > best_rank) {
            best = i;
            best_rank = rank;
        }
    }
    return first + corner(best);
}

void make_well_composed(Solid& solid) {
    std::vector<glm::ivec3> blocks;  // to be looked at
    for (int z = 0; z + 1 < solid.size.z; ++z)
        for (int y = 0; y + 1 < solid.size.y; ++y)
            for (int x = 0; x + 1 < solid.size.x; ++x)
                if (kCritical[block_at(solid, {x, y, z})]) blocks.emplace_back(x, y, z);
    while (!blocks.empty()) {
        const glm::ivec3 first = blocks.back();
        const uint32_t block = block_at(solid, first);
        if (!kCritical[block]) {
            blocks.pop_back();
            continue;
        }
        const glm::ivec3 cell = best_filling(solid, first, block);
        solid.opacity[solid.index_of(cell)] = 0.5f * (1 + solid.level);
        for (uint32_t i = 0; i < 8; ++i) blocks.push_back(cell - corner(i));
    }
}

// Marks the cells outside to which a path leads from the first cell.
std::vector<bool> outside_of(const Solid& solid) {
    std::vector<bool> reached(solid.opacity.size());
    std::vector<glm::ivec3> open = {glm::ivec3(0)};
    reached[0] = true;
    while (!open.empty()) {
        const glm::ivec3 cell = open.back();
        open.pop_back();
        for (int axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                glm::ivec3 next = cell;
                next[axis] += step;
                if (next[axis] < 0 || next[axis] >= solid.size[axis]) continue;
                const size_t index = solid.index_of(next);
                if (reached[index] || solid.inside(index)) continue;
                reached[index] = true;
                open.push_back(next);
            }
    }
    return reached;
}

// The smallest optical depths of some directions, in ascending order, of each cell.
using Least = std::array<float, kThrough>;

void keep(Least& least, float depth) {
    for (float& kept : least)
        if (depth < kept) std::swap(depth, kept);
}

// Adds to the least optical depths of cells those before them along a direction, a diagonal of the lattice.
void sweep(const Solid& solid, const std::vector<float>& sigma, const glm::ivec3& direction, std::vector<float>& before,
           std::vector<Least>& least) {
    const float step_m = glm::length(glm::vec3(direction) * solid.cell_m);
    const auto at = [&](int i, int axis) { return direction[axis] < 0 ? solid.size[axis] - 1 - i : i; };
    const auto begins = [&](int i, int axis) { return i == 0 && direction[axis] != 0; };  // the ray in this cell
    const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(solid.index_of(direction + 1)) -
                                  static_cast<std::ptrdiff_t>(solid.index_of(glm::ivec3(1)));
    for (int k = 0; k < solid.size.z; ++k)
        for (int j = 0; j < solid.size.y; ++j) {
            const size_t row = solid.index_of({0, at(j, 1), at(k, 2)});
            const bool row_begins = begins(j, 1) || begins(k, 2);
            for (int i = 0; i < solid.size.x; ++i) {
                const size_t index = row + static_cast<size_t>(at(i, 0));
                const size_t from = static_cast<size_t>(static_cast<std::ptrdiff_t>(index) - stride);
                const float depth = row_begins || begins(i, 0) ? 0 : before[from] + step_m * sigma[from];
                before[index] = depth;
                keep(least[index], depth);
            }
        }
}

// The optical depth behind which each cell lies, whatever it is seen through: kThrough directions have no more.
std::vector<float> depths_before(const Solid& solid, const std::vector<float>& sigma,
                                 const std::function<void()>& between) {
    Least none;
    none.fill(std::numeric_limits<float>::max());
    std::vector<Least> least(sigma.size(), none);
    std::vector<float> before(sigma.size());
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x)
                if (x != 0 || y != 0 || z != 0) {
                    between();
                    sweep(solid, sigma, {x, y, z}, before, least);
                }
    for (size_t i = 0; i < least.size(); ++i) before[i] = least[i].back();
    return before;
}

}  // namespace

Solid solid_of(const LeafGrid& grid, double opacity, const std::function<void()>& between) {
    Solid solid{grid.size(), grid.origin_m(), grid.cell_m(), static_cast<float>(opacity), {}};
    const size_t row = static_cast<size_t>(solid.size.x), rows = static_cast<size_t>(solid.size.y * solid.size.z);
    if (row * rows == 0) return solid;
    std::vector<float> sigma(row * rows);
    parallel_for(rows, 64, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            for (int x = 0; x < solid.size.x; ++x) {
                const int yz = static_cast<int>(i);
                const slice::Leaf* leaf = grid.leaf_of({x, yz % solid.size.y, yz / solid.size.y});
                if (leaf != nullptr) sigma[i * row + static_cast<size_t>(x)] = leaf->sigma;
            }
    });
    solid.opacity = depths_before(solid, sigma, between);
    const float edge_m = (solid.cell_m.x + solid.cell_m.y + solid.cell_m.z) / 3;
    for (size_t i = 0; i < sigma.size(); ++i)
        solid.opacity[i] = -std::expm1(-solid.opacity[i] - kReach_cells * edge_m * sigma[i]);
    make_well_composed(solid);
    const std::vector<bool> outside = outside_of(solid);
    for (size_t i = 0; i < outside.size(); ++i)
        if (!outside[i] && !solid.inside(i)) solid.opacity[i] = 1;
    return solid;
}

}  // namespace neuvv::interchange

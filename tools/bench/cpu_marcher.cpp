#include "tools/bench/rivals.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <mutex>

#include "base/threads/parallel.h"
#include "gpu/host_copies.h"
#include "shared/trace.h"
#include "voctree/files/half.h"

namespace neuvv::bench {

namespace {

// A shaded slice tree on the host (shared/slice_tree.h).
struct HostSlice {
    struct Entry {
        float sigma = 0;             // 1/m
        glm::vec3 colour{0};         // linear RGB
        uint32_t node = UINT32_MAX;  // the child node, where the entry has one
    };
    std::vector<glm::uvec4> nodes;
    std::vector<Entry> entries;
    glm::vec3 box_min{0}, box_size{1};
    uint32_t node_levels = 1, top_levels = 0;
};

// Smallest and largest distance of leaves in metres for each tile of 8×8 pixels, row by row; x > y where a tile sees
// none.
using HostTileRanges = std::vector<glm::vec2>;

uint64_t bits_of(uint32_t lo, uint32_t hi) {
    return uint64_t{hi} << 32 | lo;
}

// The walk of shaders/trace/march.glsl, for one ray.
class Marcher {
  public:
    Marcher(const HostSlice& slice, glm::vec3 origin_world, glm::vec3 direction_world, glm::vec2 range)
        : slice_(slice), side_(1 << (2 * slice.node_levels)) {
        const glm::vec3 scale = static_cast<float>(side_) / slice.box_size;
        origin_ = (origin_world - slice.box_min) * scale;
        direction_ = direction_world * scale;
        for (int axis = 0; axis < 3; ++axis)
            inverse_[axis] = 1 / (std::abs(direction_[axis]) < 1e-20f ? 1e-20f : direction_[axis]);
        const glm::vec3 a = -origin_ * inverse_, b = (static_cast<float>(side_) - origin_) * inverse_;
        const glm::vec3 near = glm::min(a, b), far = glm::max(a, b);
        t_ = std::max({near.x, near.y, near.z, range.x, 0.0f});
        t_end_ = std::min({far.x, far.y, far.z, range.y});
        cell_ = glm::clamp(glm::ivec3(glm::floor(origin_ + direction_ * t_)), 0, side_ - 1);
    }

    glm::vec4 trace(float stop) {
        glm::vec3 colour(0);
        float transmittance = 1;
        while (transmittance >= stop && inside() && t_ < t_end_) {
            const uint64_t live = enter();
            do {
                const uint32_t bit = cell_bit();
                if (!(live >> bit & 1)) {
                    const bool octant = live >> (bit & 56) & 0xff;
                    step(shift_ + (octant ? 0 : live ? 1 : 2));
                    continue;
                }
                const HostSlice::Entry& entry = slice_.entries[entry_of(live, bit)];
                ++counts_.entries;
                if (entry.node != UINT32_MAX) break;
                const float t_in = t_, t_out = step(shift_ + static_cast<int>(wide_ >> (bit >> 3) & 1));
                const float alpha = 1 - std::exp(-entry.sigma * std::max(t_out - t_in, 0.0f));
                colour += transmittance * alpha * entry.colour;
                transmittance *= 1 - alpha;
            } while (in_node_ && transmittance >= stop);
        }
        return {colour, 1 - transmittance};
    }

    const MarchCounts& counts() const { return counts_; }

  private:
    bool inside() const { return ((cell_.x | cell_.y | cell_.z) & -side_) == 0; }

    uint32_t cell_bit() const {
        const glm::uvec3 cell = glm::uvec3(cell_ >> shift_) & 3u;
        const glm::uvec3 spread = (cell & 1u) | (cell & 2u) << 2u;
        return spread.x | spread.y << 1 | spread.z << 2;
    }

    size_t entry_of(uint64_t live, uint32_t bit) const {
        uint64_t runs = live;
        for (uint32_t wide = wide_; wide; wide &= wide - 1) runs &= ~(uint64_t{0xfe} << (8 * std::countr_zero(wide)));
        if (wide_ >> (bit >> 3) & 1) bit &= 56;
        return first_ + static_cast<size_t>(std::popcount(runs & ((uint64_t{1} << bit) - 1)));
    }

    // Goes to the deepest node around the cell; returns its live cells.
    uint64_t enter() {
        shift_ = 2 * static_cast<int>(slice_.node_levels) - 2;
        in_node_ = true;
        ++counts_.nodes;
        for (uint32_t node = 0, depth = 0;; shift_ -= 2) {
            counts_.descents += depth++ > slice_.top_levels;
            const glm::uvec4& words = slice_.nodes[node];
            first_ = words.z;
            wide_ = words.w;
            const uint64_t live = bits_of(words.x, words.y);
            const uint32_t bit = cell_bit();
            if (shift_ == 0 || !(live >> bit & 1)) return live;
            node = slice_.entries[entry_of(live, bit)].node;
            if (node == UINT32_MAX) return live;
        }
    }

    // Leaves the cube of 2^shift cells a side around the cell; returns the distance where the ray leaves it.
    float step(int shift) {
        const glm::ivec3 low = (cell_ >> shift) << shift, left = cell_;
        const int size = 1 << shift;
        glm::vec3 faces;
        for (int axis = 0; axis < 3; ++axis)
            faces[axis] =
                (static_cast<float>(low[axis] + (inverse_[axis] > 0 ? size : 0)) - origin_[axis]) * inverse_[axis];
        const float t_out = std::min({faces.x, faces.y, faces.z});
        t_ = std::max(t_, t_out);
        for (int axis = 0; axis < 3; ++axis) {
            const int at = static_cast<int>(std::floor(origin_[axis] + direction_[axis] * t_));
            const int beyond = inverse_[axis] > 0 ? low[axis] + size : low[axis] - 1;
            cell_[axis] = faces[axis] <= t_out ? beyond : std::clamp(at, low[axis], low[axis] + size - 1);
        }
        const glm::ivec3 moved = (cell_ ^ left) >> (shift_ + 2);
        in_node_ = (moved.x | moved.y | moved.z) == 0;
        return t_out;
    }

    const HostSlice& slice_;
    int side_;
    glm::vec3 origin_, direction_, inverse_;  // in finest cells
    float t_, t_end_;                         // metres
    glm::ivec3 cell_;
    int shift_ = 0;
    uint32_t first_ = 0, wide_ = 0;
    bool in_node_ = false;
    MarchCounts counts_{.rays = 1};
};

// Marches one ray per pixel. Returns premultiplied linear RGB and alpha, row by row. Rays end where their transmittance
// falls below `stop`. Adds to `counts`.
std::vector<glm::vec4> march_on_host(const HostSlice& slice, const HostTileRanges& ranges, const stage::Camera& camera,
                                     float stop, MarchCounts& counts) {
    std::vector<glm::vec4> rays(size_t{camera.width} * camera.height);
    const glm::mat3 rotation(camera.world_from_camera);
    const glm::vec3 eye(camera.world_from_camera[3]);
    const uint32_t across = (camera.width + kTile - 1) / kTile;
    std::mutex adding;
    parallel_for((camera.height + kTile - 1) / kTile, 1, [&](size_t begin, size_t end) {
        MarchCounts sum;
        for (size_t row = begin * kTile; row < std::min<size_t>(end * kTile, camera.height); ++row)
            for (uint32_t x = 0; x < camera.width; ++x) {
                const glm::vec2 range = ranges[row / kTile * across + x / kTile];
                if (!(range.x < range.y)) continue;
                const glm::vec3 line{(x + 0.5 - camera.cx) / camera.fx,
                                     (camera.cy - static_cast<double>(row) - 0.5) / camera.fy, -1};
                Marcher marcher(slice, eye, glm::normalize(rotation * line), range);
                rays[row * camera.width + x] = marcher.trace(stop);
                sum.add(marcher.counts());
            }
        const std::lock_guard lock(adding);
        counts.add(sum);
    });
    return rays;
}

// The first slice of the cache.
HostSlice host_slice(const gpu::Device& device, const render::Field& field, const render::Performer& performer) {
    const render::SliceTrees& trees = performer.slices()->trees();
    HostSlice slice;
    LiveCount count;
    gpu::download(device, trees.counts, &count, sizeof(count));
    std::vector<glm::uvec2> words(std::min(count.slots, trees.capacity));
    slice.nodes.resize(field.node_count());
    gpu::download(device, trees.nodes, slice.nodes.data(), slice.nodes.size() * sizeof(glm::uvec4));
    gpu::download(device, *performer.passes().shaded(), words.data(), words.size() * sizeof(glm::uvec2));
    const auto number = [](uint32_t word, int shift) {
        return voctree::float_from_half(static_cast<uint16_t>(word >> shift));
    };
    for (const glm::uvec2 word : words) {
        if (word.x & kEntryIsNode)
            slice.entries.push_back({0, {}, word.y});
        else
            slice.entries.push_back({number(word.x, 0), {number(word.x, 16), number(word.y, 0), number(word.y, 16)}});
    }
    slice.box_min = field.box_min;
    slice.box_size = field.box_size;
    slice.node_levels = field.node_levels;
    slice.top_levels = field.top_levels;
    return slice;
}

HostTileRanges host_ranges(const gpu::Device& device, const render::TileRanges& of, size_t tiles) {
    std::vector<glm::uvec2> words(tiles);
    gpu::download(device, of.ranges, words.data(), words.size() * sizeof(glm::uvec2));
    HostTileRanges ranges;
    for (const glm::uvec2 word : words)
        ranges.push_back(word.x == kNoTile ? glm::vec2(1, 0)
                                           : glm::vec2(std::bit_cast<float>(word.x), std::bit_cast<float>(~word.y)));
    return ranges;
}

}  // namespace

void MarchCounts::add(const MarchCounts& other) {
    rays += other.rays;
    nodes += other.nodes;
    descents += other.descents;
    entries += other.entries;
}

uint64_t MarchCounts::bytes() const {
    constexpr uint64_t kGrid = 4, kNode = 16, kEntry = 8, kResult = 20;
    return nodes * (kGrid + kNode) + descents * (kEntry + kNode) + entries * kEntry + 2 * rays * kResult;
}

void measure_host(const gpu::Device& device, const render::Field& field, const render::FrameRenderer& renderer,
                  const stage::Camera& camera, uint32_t repeats, HostTimes& host) {
    const HostSlice slice = host_slice(device, field, *renderer.slices().performer());
    const size_t tiles = size_t{(camera.width + kTile - 1) / kTile} * ((camera.height + kTile - 1) / kTile);
    const HostTileRanges ranges = host_ranges(device, renderer.target().ranges, tiles);
    std::vector<glm::vec4> rays;
    for (uint32_t i = 0; i < repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        rays = march_on_host(slice, ranges, camera, render::kStopTransmittance, host.counts);
        ++host.images;
        host.ms.push_back(milliseconds_since(start));
    }
    const std::vector<glm::vec4> truth = renderer.radiance();
    for (size_t i = 0; i < rays.size(); ++i)
        for (int c = 0; c < 4; ++c)
            host.worst_difference = std::max(host.worst_difference, std::abs(double{rays[i][c]} - truth[i][c]));
}

}  // namespace neuvv::bench

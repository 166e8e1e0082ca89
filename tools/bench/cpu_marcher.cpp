#include "tools/bench/cpu_marcher.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "shared/trace.h"

namespace neuvv::bench {

namespace {

uint64_t bits_of(uint32_t lo, uint32_t hi) {
    return uint64_t{hi} << 32 | lo;
}

// The walk of shaders/march.glsl, for one ray.
class Marcher {
  public:
    Marcher(const HostSlice& slice, glm::vec3 origin_world, glm::vec3 direction_world, glm::vec2 range)
        : slice_(slice), side_(1 << (2 * slice.node_levels)) {
        const glm::vec3 scale = static_cast<float>(side_) / slice.box_size;
        origin_ = (origin_world - slice.box_min) * scale;
        direction_ = direction_world * scale;
        for (int axis = 0; axis < 3; axis++)
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
                counts_.entries++;
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
        counts_.nodes++;
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
        for (int axis = 0; axis < 3; axis++)
            faces[axis] =
                (static_cast<float>(low[axis] + (inverse_[axis] > 0 ? size : 0)) - origin_[axis]) * inverse_[axis];
        const float t_out = std::min({faces.x, faces.y, faces.z});
        t_ = std::max(t_, t_out);
        for (int axis = 0; axis < 3; axis++) {
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
    MarchCounts counts_;
};

}  // namespace

uint64_t MarchCounts::bytes() const {
    constexpr uint64_t kGrid = 4, kNode = 16, kEntry = 8, kResult = 20;
    return nodes * (kGrid + kNode) + descents * (kEntry + kNode) + entries * kEntry + 2 * rays * kResult;
}

std::vector<glm::vec4> march_on_host(const HostSlice& slice, const HostTileRanges& ranges, const stage::Camera& camera,
                                     float stop, MarchCounts& counts) {
    std::vector<glm::vec4> rays(size_t{camera.width} * camera.height);
    const glm::mat3 rotation(camera.world_from_camera);
    const glm::vec3 eye(camera.world_from_camera[3]);
    const uint32_t across = (camera.width + kTile - 1) / kTile;
    std::mutex adding;
    parallel_for((camera.height + kTile - 1) / kTile, 1, [&](size_t begin, size_t end) {
        MarchCounts sum;
        for (size_t row = begin * kTile; row < std::min<size_t>(end * kTile, camera.height); row++)
            for (uint32_t x = 0; x < camera.width; x++) {
                const glm::vec2 range = ranges[row / kTile * across + x / kTile];
                if (!(range.x < range.y)) continue;
                const glm::vec3 line{(x + 0.5 - camera.cx) / camera.fx,
                                     (camera.cy - static_cast<double>(row) - 0.5) / camera.fy, -1};
                Marcher marcher(slice, eye, glm::normalize(rotation * line), range);
                rays[row * camera.width + x] = marcher.trace(stop);
                sum.rays++;
                sum.nodes += marcher.counts().nodes;
                sum.descents += marcher.counts().descents;
                sum.entries += marcher.counts().entries;
            }
        const std::lock_guard lock(adding);
        counts.rays += sum.rays;
        counts.nodes += sum.nodes;
        counts.descents += sum.descents;
        counts.entries += sum.entries;
    });
    return rays;
}

}  // namespace neuvv::bench

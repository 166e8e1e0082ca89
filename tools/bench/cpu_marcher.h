// The same rays through the same slice tree by plain C++ on all cores: what a software device's speed is held against.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stage/camera.h"

namespace neuvv::bench {

// A shaded slice tree on the host (shared/slice_tree.h).
struct HostSlice {
    struct Entry {
        float sigma = 0;             // 1/m
        glm::vec3 colour{0};         // linear RGB
        uint32_t node = UINT32_MAX;  // of a child node's entry
    };
    std::vector<glm::uvec4> nodes;
    std::vector<Entry> entries;
    glm::vec3 box_min{0}, box_size{1};
    uint32_t node_levels = 1, top_levels = 0;
};

// What walks touched, as the device's walk would: from the grid over the upper levels.
struct MarchCounts {
    uint64_t rays = 0;      // in tiles that see anything
    uint64_t nodes = 0;     // entered
    uint64_t descents = 0;  // to them, from the nodes that the grid names
    uint64_t entries = 0;   // read at leaves
    uint64_t bytes() const;
};

// Least and largest distance of each 8×8 tile, row by row; none (x > y) where a tile sees nothing.
using HostTileRanges = std::vector<glm::vec2>;

// One ray a pixel: premultiplied linear RGB and alpha, in rows. Rays end where transmittance falls below `stop`.
// `counts` are added to.
std::vector<glm::vec4> march_on_host(const HostSlice& slice, const HostTileRanges& ranges, const stage::Camera& camera,
                                     float stop, MarchCounts& counts);

}  // namespace neuvv::bench

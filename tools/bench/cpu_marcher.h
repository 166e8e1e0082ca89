// Marches the rays of an image through a shaded slice tree by plain C++ on all cores, to compare a device's speed with.
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
        uint32_t node = UINT32_MAX;  // the child node, where the entry has one
    };
    std::vector<glm::uvec4> nodes;
    std::vector<Entry> entries;
    glm::vec3 box_min{0}, box_size{1};
    uint32_t node_levels = 1, top_levels = 0;
};

// What rays have read, counted as the device reads it, whose walks begin at the grid over the upper levels.
struct MarchCounts {
    uint64_t rays = 0;      // in tiles that may see a leaf
    uint64_t nodes = 0;     // entered
    uint64_t descents = 0;  // steps from a node to its child, below the nodes that the grid names
    uint64_t entries = 0;   // read at leaves
    uint64_t bytes() const;
};

// Smallest and largest distance of leaves in metres for each tile of 8×8 pixels, row by row; x > y where a tile sees
// none.
using HostTileRanges = std::vector<glm::vec2>;

// Marches one ray per pixel. Returns premultiplied linear RGB and alpha, row by row. Rays end where their transmittance
// falls below `stop`. Adds to `counts`.
std::vector<glm::vec4> march_on_host(const HostSlice& slice, const HostTileRanges& ranges, const stage::Camera& camera,
                                     float stop, MarchCounts& counts);

}  // namespace neuvv::bench

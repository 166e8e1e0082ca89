// The same rays through the same slice tree by plain C++ on all cores: what a software device's speed is held against.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stage/camera.h"

namespace neuvv {

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
    uint32_t node_levels = 1;
};

// Least and largest distance of each 8×8 tile, row by row; none (x > y) where a tile sees nothing.
using HostTileRanges = std::vector<glm::vec2>;

// One ray a pixel: premultiplied linear RGB and alpha, in rows. Rays end where transmittance falls below `stop`.
std::vector<glm::vec4> march_on_host(const HostSlice& slice, const HostTileRanges& ranges, const Camera& camera,
                                     float stop);

}  // namespace neuvv

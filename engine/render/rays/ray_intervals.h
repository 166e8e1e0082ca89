// Intervals of rays on the host: which leaves of which performers a ray passes through, for what needs more of a ray
// than its light.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace neuvv::render {

// The part of a ray inside a leaf.
struct RayInterval {
    float near_m = 0, far_m = 0;  // along the ray, world
    float optical_depth = 0;
    glm::vec3 colour{0};     // linear, as the stage's lights show it, not premultiplied
    uint32_t instance = 0;   // intervals of an instance stand together, from near to far
    uint32_t performer = 0;  // Instance::performer
};

// A homogeneous part of a ray.
struct RayStretch {
    float near_m = 0, far_m = 0;  // along the ray, world
    float before = 1, after = 1;  // transmittance from the eye to its ends
    glm::vec3 light{0};           // that it sends to the eye
};

// The share of what the eye sees along a ray.
struct SeenPerformer {
    uint32_t performer = 0;
    float share = 0;
};

struct MergedRay {
    std::vector<RayStretch> stretches;  // from near to far, those that let less than all through
    std::vector<SeenPerformer> seen;    // in no order, each performer once; the shares' sum is the ray's alpha
};

// What merge.comp does: where intervals of several instances overlap, densities add up and colours are weighted by
// density. The ray ends where less than `stop` passes.
MergedRay merge_intervals(std::span<const RayInterval> intervals, float stop);

// Pages of intervals, as shared/intervals.h describes them. `pages_after` has the number of pages in use after each
// instance that was traced, one after the other; `performers` has whose they are.
struct IntervalPages {
    std::span<const glm::uvec4> texels;
    std::span<const uint32_t> pages_after, performers;
};
// Appends the intervals of a ray, whose first list begins at page `first` (0: it has none).
void read_intervals(const IntervalPages& pages, uint32_t first, std::vector<RayInterval>& intervals);

}  // namespace neuvv::render

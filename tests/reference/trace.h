// Trace: the exact march of a ray through a VOctree. Leaves are found by descent with slab tests, never by stepping, so
// that this shares nothing with the GPU's traversal.
#pragma once

#include <vector>

#include "reference/composite.h"
#include "reference/sample.h"

namespace neuvv::reference {

struct Ray {
    glm::dvec3 origin{0};            // world, metres
    glm::dvec3 direction{0, 0, -1};  // world, unit length
    double t_min = 0;                // metres; what lies nearer is not seen
};

// The part of a ray inside one leaf, in metres along the ray.
struct Segment {
    uint32_t leaf = 0;
    double t_enter = 0;
    double t_exit = 0;
};

// Where a ray is between two of its places, metres; nowhere (enter ≥ exit) where it is not.
struct Interval {
    double enter = 0;
    double exit = 0;
    bool empty() const { return !(enter < exit); }
};
// Where it is inside the cells from `first` up to before `end` of a grid of `side` cells an axis over the tree's box.
// Boxes that share a face share the very number there, whatever their sizes.
Interval intersect_box(const voctree::VOctree& tree, const Ray& ray, glm::uvec3 first, glm::uvec3 end, double side);

// All segments of positive length, near to far. A leaf gives at most one, however many cells of its node it fills.
// Neighbours share the very number at their border.
std::vector<Segment> intersect(const voctree::VOctree& tree, const Ray& ray);

// The samples of a ray at one time, from slices (by leaf index) or from all weights.
std::vector<Sample> ray_samples(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray);
std::vector<Sample> ray_samples_direct(const voctree::VOctree& tree, double frame, const Ray& ray);

// The same with the colour of a leaf as seen from `eye` at its middle (shading), whatever the ray's direction.
std::vector<Sample> ray_samples_shaded(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices,
                                       const std::vector<voctree::LeafPosition>& places, glm::dvec3 eye,
                                       const Ray& ray);

RayResult trace(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray,
                double stop_transmittance = 0);
RayResult trace_direct(const voctree::VOctree& tree, double frame, const Ray& ray, double stop_transmittance = 0);

// What a ray's loss says to one leaf's slice.
struct LeafSliceGradient {
    uint32_t leaf = 0;
    double sigma = 0;
    ShCoefficients k{};
};
// One entry for each segment of intersect().
std::vector<LeafSliceGradient> trace_adjoint(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices,
                                             const Ray& ray, glm::dvec3 d_colour, double d_alpha,
                                             double stop_transmittance = 0);

}  // namespace neuvv::reference

// Trace: the exact walk of a ray through a VOctree. Leaves are found by descent with slab tests, not by stepping, so
// that this shares nothing with the traversal in the shaders.
#pragma once

#include <vector>

#include "reference/composite.h"
#include "reference/sample.h"

namespace neuvv::reference {

struct Ray {
    glm::dvec3 origin{0};            // world, metres
    glm::dvec3 direction{0, 0, -1};  // world, unit length
    double t_min = 0;                // metres; the ray begins at this distance
};

// The part of a ray inside one leaf, in metres along the ray.
struct LeafInterval {
    uint32_t leaf = 0;
    double t_enter = 0;
    double t_exit = 0;
};

// A part of a ray, metres along it; empty where enter ≥ exit.
struct Interval {
    double enter = 0;
    double exit = 0;
    bool empty() const { return !(enter < exit); }
};
// The part of a ray inside the cells from `first` to before `end` of a grid that divides the tree's box into `side`
// cells along each axis. Two boxes that share a face get exactly the same number for it, whatever their sizes.
Interval intersect_box(const voctree::VOctree& tree, const Ray& ray, glm::uvec3 first, glm::uvec3 end, double side);

// All intervals of positive length, near to far. A leaf gives at most one, however many cells of its node it fills.
// Neighbouring intervals have exactly the same number at their common border.
std::vector<LeafInterval> intersect(const voctree::VOctree& tree, const Ray& ray);

// The samples of a ray at one time, from slices (by leaf index) or from all weights.
std::vector<Sample> ray_samples(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray);
std::vector<Sample> ray_samples_direct(const voctree::VOctree& tree, double frame, const Ray& ray);

// The same, but each leaf has the colour in the direction from `eye` to its centre (shading), whatever the ray's
// direction.
std::vector<Sample> ray_samples_shaded(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices,
                                       const std::vector<voctree::LeafPosition>& positions, glm::dvec3 eye,
                                       const Ray& ray);

RayResult trace(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray,
                double stop_transmittance = 0);
RayResult trace_direct(const voctree::VOctree& tree, double frame, const Ray& ray, double stop_transmittance = 0);

// The derivatives of a ray's loss by one leaf's slice.
struct LeafSliceGradient {
    uint32_t leaf = 0;
    double sigma = 0;
    ShCoefficients k{};
};
// One entry for each interval of intersect().
std::vector<LeafSliceGradient> trace_adjoint(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices,
                                             const Ray& ray, glm::dvec3 d_colour, double d_alpha,
                                             double stop_transmittance = 0);

}  // namespace neuvv::reference

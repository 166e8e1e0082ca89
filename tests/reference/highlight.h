// Highlight: to which bone a leaf belongs, and its colour once it is tinted.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace neuvv::reference {

struct Capsule {
    glm::dvec3 from{0}, to{0};
    double radius = 0;
};

// The distance from a point to the capsule's surface; negative inside.
double distance_to(const Capsule& bone, const glm::dvec3& point);
// The index of the nearest; of several the first.
size_t nearest_bone(const std::vector<Capsule>& bones, const glm::dvec3& point);

// The colour mixed with red of its own luminance; tint 0..1.
glm::dvec3 tinted(const glm::dvec3& colour, double tint);

}  // namespace neuvv::reference

#include "reference/highlight.h"

#include <algorithm>

#include "shared/highlight.h"

namespace neuvv::reference {

double distance_to(const Capsule& bone, const glm::dvec3& point) {
    const glm::dvec3 line = bone.to - bone.from;
    const double length2 = glm::dot(line, line);
    const double along = length2 > 0 ? std::clamp(glm::dot(point - bone.from, line) / length2, 0.0, 1.0) : 0;
    return glm::distance(point, bone.from + along * line) - bone.radius;
}

size_t nearest_bone(const std::vector<Capsule>& bones, const glm::dvec3& point) {
    const auto nearest = std::ranges::min_element(bones, {}, [&](const Capsule& b) { return distance_to(b, point); });
    return static_cast<size_t>(nearest - bones.begin());
}

glm::dvec3 tinted(const glm::dvec3& colour, double tint) {
    const double light = 0.4 + 0.6 * glm::dot(colour, glm::dvec3(0.2126, 0.7152, 0.0722));
    return glm::mix(colour, light * glm::dvec3(1, 0.05, 0.03), static_cast<double>(kHighlightShare) * tint);
}

}  // namespace neuvv::reference

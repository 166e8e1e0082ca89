#include "training/data/layouts/rig/world_of_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace neuvv::training {

namespace {

// A float has 24 bits, and an image some 12: at 64 times the rig's size from the origin, positions are exact to a 64th
// of a pixel.
constexpr double kFarthestOfSize = 64;  // of the rig's size
// Smaller captures need densities beyond fp16, larger ones have densities and positions that it rounds away.
constexpr double kSmallestSize = 0.05, kLargestSize = 1e4;

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Medians, so that a camera that is calibrated wrongly does not count. Positions count once, as splits repeat some.
glm::dvec3 median_position(const std::vector<glm::dvec3>& positions) {
    glm::dvec3 centre(0);
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> along;
        for (const glm::dvec3& position : positions) along.push_back(position[axis]);
        centre[axis] = median_of(along);
    }
    return centre;
}

// How far from the cameras the point nearest to their optical axes is; 0 where they look in one direction. Cameras
// further away than `most` do not count.
double distance_to_scene(const std::vector<glm::dmat4>& poses, const glm::dvec3& centre, double most) {
    glm::dmat3 normal(0);
    glm::dvec3 right(0);
    double count = 0;
    for (const glm::dmat4& pose : poses) {
        if (glm::distance(glm::dvec3(pose[3]), centre) > most) continue;
        ++count;
        const glm::dvec3 axis(pose[2]);
        const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(axis, axis);
        normal += across;
        right += across * (glm::dvec3(pose[3]) - centre);
    }
    constexpr double kLeastSpread = 1e-4;  // of the directions, below which their crossing is not known
    if (glm::determinant(normal / count) < kLeastSpread) return 0;
    return glm::length(glm::inverse(normal) * right);
}

double power_of_ten(double exponent) {
    return std::pow(10.0, exponent);
}

}  // namespace

voctree::WorldFrame world_of(const std::vector<glm::dmat4>& poses,
                             const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box) {
    std::set<std::array<double, 3>> distinct;
    for (const glm::dmat4& pose : poses) distinct.insert({pose[3].x, pose[3].y, pose[3].z});
    if (distinct.empty()) return {};
    std::vector<glm::dvec3> positions;
    for (const auto& [x, y, z] : distinct) positions.emplace_back(x, y, z);
    const glm::dvec3 centre = median_position(positions);
    std::vector<double> distances;
    for (const glm::dvec3& position : positions) distances.push_back(glm::distance(position, centre));
    const double spread = median_of(distances);
    double size = std::max(spread, distance_to_scene(poses, centre, kFarthestOfSize * spread));
    if (box) size = std::max(size, 0.5 * glm::distance(box->first, box->second));
    if (!(size > 0) || !std::isfinite(size)) return {};
    voctree::WorldFrame world;
    if (size < kSmallestSize || size > kLargestSize) world.unit = power_of_ten(std::floor(std::log10(size)));
    const double step = power_of_ten(std::ceil(std::log10(size)));
    if (glm::length(centre) > kFarthestOfSize * size) world.origin = glm::round(centre / step) * step;
    return world;
}

void place_near_origin(Rig& rig) {
    rig.frame = world_of(rig.poses, rig.box);
    if (rig.frame.is_same()) return;
    for (RigCamera& camera : rig.cameras)
        camera.world_from_camera = rig.frame.pose_from_capture(camera.world_from_camera);
    if (rig.box) rig.box = {rig.frame.from_capture(rig.box->first), rig.frame.from_capture(rig.box->second)};
    const glm::dvec3& o = rig.frame.origin;
    std::string remark =
        fmt::format("the capture's ({:.15g}, {:.15g}, {:.15g}) becomes the clip's origin", o.x, o.y, o.z);
    if (rig.frame.unit != 1) remark += fmt::format(", and {:.6g} of its units the clip's metre", rig.frame.unit);
    rig.remarks.push_back(remark + ": the clip remembers it (training/data/layouts/README.md)");
}

}  // namespace neuvv::training

#include "motion/video/best_view.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace neuvv::motion {

double visible_error(std::span<const WeightedError> errors, const glm::dvec3& view) {
    double sum = 0;
    for (const WeightedError& each : errors) {
        const double along = glm::dot(view, each.error);
        sum += each.weight * (glm::dot(each.error, each.error) - along * along);
    }
    return sum;
}

glm::dvec3 best_view_direction(std::span<const WeightedError> errors) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    for (const WeightedError& each : errors) {
        const Eigen::Vector3d e(each.error.x, each.error.y, each.error.z);
        matrix += each.weight * e * e.transpose();
    }
    const double total = matrix.trace();
    if (!(total > 0)) return {0, 0, 1};
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);  // eigenvalues ascend
    const auto vector = [&](int column) {
        const Eigen::Vector3d v = solver.eigenvectors().col(column);
        return glm::dvec3(v[0], v[1], v[2]);
    };
    // Where the two least are alike, any direction between their vectors shows as much: the level one is in the plane
    // across the third.
    constexpr double kAlike = 0.02;
    if (solver.eigenvalues()[1] - solver.eigenvalues()[0] < kAlike * total) {
        const glm::dvec3 level = glm::cross(vector(2), glm::dvec3(0, 1, 0));
        if (glm::length(level) > 1e-3) return glm::normalize(level);
        return {0, 0, 1};  // all errors are vertical
    }
    return vector(0);
}

glm::dvec3 best_level_view(std::span<const WeightedError> errors) {
    double xx = 0, xz = 0, zz = 0;
    for (const WeightedError& each : errors) {
        xx += each.weight * each.error.x * each.error.x;
        xz += each.weight * each.error.x * each.error.z;
        zz += each.weight * each.error.z * each.error.z;
    }
    // The axis of the most level error; the view is across it.
    const double axis = 0.5 * std::atan2(2 * xz, xx - zz);
    return {-std::sin(axis), 0, std::cos(axis)};
}

}  // namespace neuvv::motion

#include "interchange/camera/json_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace neuvv::interchange {

namespace {

constexpr double kRigidTolerance = 1e-3;  // some files give poses with only 4 digits

}  // namespace

void expect_rigid(const JsonNode& node, const glm::dmat4& pose) {
    const glm::dmat3 axes(pose);
    const glm::dvec3 lengths(glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]));
    for (int i = 0; i < 3; ++i)
        if (std::abs(lengths[i] - 1) > kRigidTolerance)
            node.fail(
                fmt::format("is scaled: its axes have lengths {:.4g}, {:.4g}, {:.4g}", lengths.x, lengths.y, lengths.z),
                "divide the scale out of the left 3×3 part");
    const double skew = std::max({std::abs(glm::dot(axes[0], axes[1])), std::abs(glm::dot(axes[1], axes[2])),
                                  std::abs(glm::dot(axes[2], axes[0]))});
    if (skew > kRigidTolerance) node.fail("is sheared: its axes are not at right angles", "give a rigid pose");
    if (glm::determinant(axes) < 0)
        node.fail("is left-handed (determinant -1)", "flip one axis: +X right, +Y up, the camera looks along -Z");
    for (int i = 0; i < 3; ++i)
        if (std::abs(pose[3][i]) > kMaxDistance_m)
            node.fail(fmt::format("stands more than {:g} m from the origin", kMaxDistance_m), "give metres");
}

glm::dmat4 json_pose(const JsonNode& node) {
    if (!node.value.is_array()) node.fail_type("an array");
    const size_t rows = node.value.size();
    if (rows != 3 && rows != 4) node.fail(fmt::format("has {} rows", rows), "give 4×4 or 3×4 numbers, row by row");
    glm::dmat4 pose(1);
    for (size_t row = 0; row < rows; ++row) {
        expect_array(node[row], 4);
        for (size_t column = 0; column < 4; ++column)
            pose[static_cast<int>(column)][static_cast<int>(row)] = json_number(node[row][column]);
    }
    for (int column = 0; column < 4; ++column)
        if (std::abs(pose[column][3] - (column == 3 ? 1 : 0)) > kRigidTolerance)
            node[3].fail("is not 0 0 0 1", "give the matrix row by row, camera to world");
    expect_rigid(node, pose);
    return pose;
}

}  // namespace neuvv::interchange

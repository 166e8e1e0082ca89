#include "tools/viewer/panels/node_transform.h"

#include <cmath>

#include "stage/pose.h"

namespace neuvv::viewer {

namespace {

// The height of the lowest point of a node and of its descendants in the world; INFINITY where they have no points.
double lowest_of(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, uint32_t node) {
    double lowest = INFINITY;
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        if (stage.performers[performer.performer].node != node) continue;
        const stage::StageClip& clip = stage.clips[performer.clip];
        const glm::dvec3 high = clip.box_min + clip.box_size;
        glm::dvec3 low = clip.box_min;
        if (low.y < 0 && high.y > 0) low.y = 0;
        for (int i = 0; i < 8; ++i) {
            const glm::dvec3 corner = glm::mix(low, high, glm::dvec3(i & 1, i >> 1 & 1, i >> 2));
            lowest = std::min(lowest, (performer.world_from_performer * glm::dvec4(corner, 1)).y);
        }
    }
    const stage::GltfNode& source = stage.scene.nodes[node];
    if (source.mesh >= 0) {
        stage::PosedVertices posed;
        for (const stage::GltfPrimitive& primitive : stage.scene.meshes[static_cast<size_t>(source.mesh)].primitives) {
            stage::pose_vertices(stage.scene, evaluated.pose, node, primitive, posed);
            for (const glm::vec3& position : posed.positions)
                lowest = std::min(lowest, static_cast<double>(position.y));
        }
    }
    for (const uint32_t child : source.children) lowest = std::min(lowest, lowest_of(stage, evaluated, child));
    return lowest;
}

}  // namespace

// R = Rz · Ry · Rx. At the poles of Y, where X and Z rotate about the same axis, Z is 0.
glm::dvec3 angles_of(const glm::dquat& rotation) {
    const glm::dmat3 m = glm::mat3_cast(rotation);
    const double sin_y = -m[0][2], cos_y = std::hypot(m[0][0], m[0][1]);
    glm::dvec3 angles(0, std::atan2(sin_y, cos_y), 0);
    if (cos_y > 1e-9) {
        angles.x = std::atan2(m[1][2], m[2][2]);
        angles.z = std::atan2(m[0][1], m[0][0]);
    } else {
        angles.x = std::atan2(std::copysign(1.0, sin_y) * m[1][0], m[1][1]);
    }
    return glm::degrees(angles);
}

glm::dquat rotation_of(const glm::dvec3& angles_deg) {
    const glm::dvec3 a = glm::radians(angles_deg);
    return glm::angleAxis(a.z, glm::dvec3(0, 0, 1)) * glm::angleAxis(a.y, glm::dvec3(0, 1, 0)) *
           glm::angleAxis(a.x, glm::dvec3(1, 0, 0));
}

glm::dvec3 angles_like(const glm::dvec3& displayed_deg, const glm::dquat& rotation) {
    constexpr double kSame = 1e-12;
    return 1 - std::abs(glm::dot(rotation_of(displayed_deg), rotation)) < kSame ? displayed_deg : angles_of(rotation);
}

edit::Placement placement_to(const edit::NodeTransform& from, const edit::NodeTransform& to) {
    edit::Placement placement;
    if (to.translation != from.translation) placement.at = to.translation;
    if (to.rotation != from.rotation) placement.turn_deg = angles_of(to.rotation * glm::conjugate(from.rotation));
    if (to.scale == from.scale) return placement;
    placement.scale = glm::dvec3(1);
    for (int axis = 0; axis < 3; ++axis)
        if (from.scale[axis] != 0) (*placement.scale)[axis] = to.scale[axis] / from.scale[axis];
    return placement;
}

glm::dvec3 nonzero_scale(const glm::dvec3& scale, const glm::dvec3& before) {
    glm::dvec3 nonzero = scale;
    for (int axis = 0; axis < 3; ++axis) {
        if (scale[axis] == before[axis]) continue;
        const bool changes_sign = (scale[axis] < 0) != (before[axis] < 0);
        nonzero[axis] =
            std::copysign(changes_sign ? kMinScale : std::max(kMinScale, std::abs(scale[axis])), before[axis]);
    }
    return nonzero;
}

std::optional<glm::dvec3> move_to_floor(const stage::Stage& stage, const stage::EvaluatedStage& evaluated,
                                        uint32_t node) {
    const double lowest = lowest_of(stage, evaluated, node);
    if (!std::isfinite(lowest)) return {};
    const int32_t parent = stage.scene.nodes[node].parent;
    if (parent < 0) return glm::dvec3(0, -lowest, 0);
    const glm::dmat3 axes(evaluated.pose.world_from_node[static_cast<size_t>(parent)]);
    const glm::dvec3 move = glm::inverse(axes) * glm::dvec3(0, -lowest, 0);
    if (!(glm::length(move) < 1e9)) return {};
    return move;
}

}  // namespace neuvv::viewer

#include "training/rig/camera_pose.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace neuvv::training {

namespace {

constexpr double kMaxShift = 0.02;  // of the distance

}  // namespace

stage::Camera moved(const stage::Camera& given, const PoseChange& change) {
    stage::Camera camera = given;
    const glm::dvec3 turn(change[kTurnX], change[kTurnY], change[kTurnZ]);
    const glm::dvec4 shift(change[kShiftX], change[kShiftY], change[kShiftZ], 0);
    const double angle = glm::length(turn);
    const glm::dmat4& pose = given.world_from_camera;
    if (angle > 0) camera.world_from_camera = pose * glm::rotate(glm::dmat4(1), angle, turn / angle);
    camera.world_from_camera[3] = pose[3] + pose * shift;
    camera.fx *= std::exp(change[kZoom]);
    camera.fy *= std::exp(change[kZoom]);
    return camera;
}

std::vector<stage::Camera> moved(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& changes) {
    assert((changes.empty() || changes.size() == given.size()) && "a change for each camera");
    std::vector<stage::Camera> cameras = given;
    for (size_t i = 0; i < changes.size(); ++i) cameras[i] = moved(given[i], changes[i]);
    return cameras;
}

double distance_to(const stage::Camera& camera, glm::dvec3 point) {
    return glm::length(glm::dvec3(camera.world_from_camera[3]) - point);
}

PoseChange pose_steps(const stage::Camera& camera, glm::dvec3 centre, double pixels) {
    const double across = pixels / camera.fx;
    // To turn about the axis, to move along it and to zoom moves what is far from the image's centre.
    const double outwards = 4 * pixels / std::min(camera.width, camera.height);
    const double distance = distance_to(camera, centre);
    return {across, across, outwards, distance * across, distance * across, distance * outwards, outwards};
}

PoseChange pose_bounds(const stage::Camera& camera, glm::dvec3 centre) {
    const double shift = kMaxShift * distance_to(camera, centre);
    return {kMaxTurn, kMaxTurn, kMaxTurn, shift, shift, shift, kMaxZoom};
}

bool is_possible(const PoseChange& change) {
    for (size_t i = 0; i < kPoseNumbers; ++i) {
        const double most = i < kShiftX ? kMaxTurn : i < kZoom ? kMaxShiftMetres : kMaxZoom;
        if (!(std::abs(change[i]) <= most)) return false;
    }
    return true;
}

bool is_at_bound(const PoseChange& change, const PoseChange& bounds) {
    for (size_t i = 0; i < kPoseNumbers; ++i)
        if (std::abs(change[i]) >= bounds[i]) return true;
    return false;
}

std::array<glm::dvec3, kScenePoints> scene_points(const stage::Camera& camera, glm::dvec3 centre) {
    const double extent = kSceneExtent * distance_to(camera, centre);
    std::array<glm::dvec3, kScenePoints> points;
    for (size_t i = 0; i < kScenePoints; ++i)
        points[i] = centre + extent * glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    return points;
}

glm::dvec2 seen_at(const stage::Camera& camera, glm::dvec3 point) {
    const glm::dvec3 direction =
        glm::normalize(glm::dvec3(glm::inverse(camera.world_from_camera) * glm::dvec4(point, 1)));
    return {camera.fx * direction.x, -camera.fy * direction.y};
}

double image_motion(const stage::Camera& given, const PoseChange& change, glm::dvec3 centre) {
    const stage::Camera changed = moved(given, change);
    double sum = 0;
    for (const glm::dvec3& point : scene_points(given, centre)) {
        const glm::dvec2 by = seen_at(changed, point) - seen_at(given, point);
        sum += glm::dot(by, by);
    }
    return std::sqrt(sum / kScenePoints);
}

}  // namespace neuvv::training

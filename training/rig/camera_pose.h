// What training learns of the pose and the lens of each camera (`--refine poses`): small changes of the calibration.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "stage/camera.h"

namespace neuvv::training {

// The numbers of a camera's change, in the camera's own axes: the angles of a rotation about its position, in radians;
// metres; the logarithm of the factor of its focal lengths.
enum PoseNumber { kTurnX, kTurnY, kTurnZ, kShiftX, kShiftY, kShiftZ, kZoom, kPoseNumbers };
using PoseChange = std::array<double, kPoseNumbers>;

// No run finds larger numbers: radians, metres, logarithm.
constexpr double kMaxTurn = 0.035, kMaxShiftMetres = 1e5, kMaxZoom = 0.05;

// Whether all numbers are finite and within these bounds.
bool is_possible(const PoseChange& change);

// The camera after the change.
stage::Camera moved(const stage::Camera& given, const PoseChange& change);

// The same for all cameras; without changes, those given. Otherwise there must be one for each camera (assert).
std::vector<stage::Camera> moved(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& changes);

// Metres from a camera to a point of the world.
double distance_to(const stage::Camera& camera, glm::dvec3 point);

// By how much each number has to change for the image of a scene around `centre` to move by about `pixels` pixels.
PoseChange pose_steps(const stage::Camera& camera, glm::dvec3 centre, double pixels);

// How far the numbers may be from 0: 2 degrees, 2 % of the distance from `centre`, 5 % of focal length.
PoseChange pose_bounds(const stage::Camera& camera, glm::dvec3 centre);

// Whether one of the numbers lies at its bound, or beyond.
bool is_at_bound(const PoseChange& change, const PoseChange& bounds);

constexpr size_t kScenePoints = 8;
constexpr double kSceneExtent = 0.15;

// The corners of a cube around `centre`, which reaches kSceneExtent of the camera's distance to each side: they stand
// for the scene where the motion of its image is measured.
std::array<glm::dvec3, kScenePoints> scene_points(const stage::Camera& camera, glm::dvec3 centre);

// Where a camera sees a point of the world, in pixels from the centre of its image, as if the lens were orthographic in
// angles: near the centre that is the pinhole's position, and it exists in all directions.
glm::dvec2 seen_at(const stage::Camera& camera, glm::dvec3 point);

// By how many pixels the change moves the image of a scene around `centre`, as the root of the mean square.
double image_motion(const stage::Camera& given, const PoseChange& change, glm::dvec3 centre);

}  // namespace neuvv::training

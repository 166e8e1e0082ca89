// Changes of cameras' poses, and the solver that finds them, on points whose images are known.
#include "training/rig/camera_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/rig/pose_solver.h"

namespace neuvv::test {
namespace {

using training::kPoseNumbers;
using training::PoseChange;

const glm::dvec3 kCentre(0.05, 0.1, -0.05);

std::vector<stage::Camera> ring(uint32_t cameras) {
    std::vector<stage::Camera> result;
    for (uint32_t i = 0; i < cameras; ++i)
        result.push_back(sphere_camera({.cameras = cameras, .size = 200, .distance_m = 3}, i));
    return result;
}

// Changes of up to about 0.3 degrees and 5 mm.
std::vector<PoseChange> small_changes(size_t cameras, uint64_t seed) {
    Random random(seed);
    std::vector<PoseChange> changes(cameras);
    for (PoseChange& change : changes)
        for (size_t i = 0; i < kPoseNumbers; ++i) change[i] = i == training::kZoom ? 0 : random.uniform(-1, 1) * 0.004;
    return changes;
}

// What a camera that stands as `now` finds, where images show that it stands as `truth`: positions of points in pixels.
training::PoseEvidence evidence_of(const stage::Camera& given, const PoseChange& now, const PoseChange& truth) {
    training::PoseEvidence evidence;
    const stage::Camera standing = training::moved(given, now), right = training::moved(given, truth);
    constexpr double kStep = 1e-5;
    for (const glm::dvec3& corner : training::scene_points(given, kCentre))
        for (const double depth : {0.3, 1.0, 1.6}) {
            const glm::dvec3 point = kCentre + depth * (corner - kCentre);
            const glm::dvec2 error = training::seen_at(standing, point) - training::seen_at(right, point);
            std::array<glm::dvec2, kPoseNumbers> slope;
            for (size_t i = 0; i < kPoseNumbers; ++i) {
                PoseChange more = now;
                more[i] += kStep;
                const stage::Camera stepped = training::moved(given, more);
                slope[i] = (training::seen_at(stepped, point) - training::seen_at(standing, point)) / kStep;
            }
            // As many residuals as the tiles of a round give, so that the prior weighs as little.
            for (int i = 0; i < 400; ++i) {
                const int axis = i % 2;
                PoseChange derivatives;
                for (size_t k = 0; k < kPoseNumbers; ++k) derivatives[k] = slope[k][axis];
                evidence.add(error[axis], derivatives, 1);
            }
        }
    return evidence;
}

// The root of the mean square, over cameras, of how far images lie from where they should.
double image_error(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& found,
                   const std::vector<PoseChange>& truth) {
    double sum = 0;
    for (size_t i = 0; i < given.size(); ++i) {
        const stage::Camera at = training::moved(given[i], found[i]), right = training::moved(given[i], truth[i]);
        for (const glm::dvec3& point : training::scene_points(given[i], kCentre)) {
            const glm::dvec2 by = training::seen_at(at, point) - training::seen_at(right, point);
            sum += glm::dot(by, by);
        }
    }
    return std::sqrt(sum / static_cast<double>(given.size() * training::kScenePoints));
}

std::vector<PoseChange> rounds(const std::vector<stage::Camera>& given, std::vector<PoseChange> changes,
                               const std::vector<PoseChange>& truth, int count) {
    for (int round = 0; round < count; ++round) {
        std::vector<training::PoseEvidence> evidence;
        for (size_t i = 0; i < given.size(); ++i) evidence.push_back(evidence_of(given[i], changes[i], truth[i]));
        changes = training::next_poses(given, changes, evidence, kCentre, 1);
    }
    return changes;
}

TEST(CameraPose, MovesByItsNumbersInTheCamerasOwnAxes) {
    const stage::Camera given = ring(5)[1];
    const auto axis = [](const stage::Camera& camera, int i) { return glm::dvec3(camera.world_from_camera[i]); };
    const stage::Camera shifted = training::moved(given, {0, 0, 0, 0.25, 0, 0, 0});
    EXPECT_LT(glm::distance(axis(shifted, 3), axis(given, 3) + 0.25 * axis(given, 0)), 1e-12);
    const stage::Camera turned = training::moved(given, {0, 0.1, 0, 0, 0, 0, 0});
    EXPECT_LT(glm::distance(axis(turned, 2), std::cos(0.1) * axis(given, 2) + std::sin(0.1) * axis(given, 0)), 1e-12);
    EXPECT_LT(glm::distance(axis(turned, 3), axis(given, 3)), 1e-12);
    const stage::Camera zoomed = training::moved(given, {0, 0, 0, 0, 0, 0, std::log(1.5)});
    EXPECT_NEAR(zoomed.fx, 1.5 * given.fx, 1e-9);
    EXPECT_NEAR(zoomed.fy, 1.5 * given.fy, 1e-9);
    EXPECT_EQ(training::moved(ring(3), {}).size(), 3u);
}

TEST(CameraPose, AStepMovesTheImageByAboutAsManyPixels) {
    const stage::Camera camera = ring(5)[2];
    const PoseChange steps = training::pose_steps(camera, kCentre, 2);
    for (size_t i = 0; i < kPoseNumbers; ++i) {
        PoseChange change{};
        change[i] = steps[i];
        const double motion = training::image_motion(camera, change, kCentre);
        EXPECT_GT(motion, 0.8) << i;
        EXPECT_LT(motion, 4) << i;
    }
    EXPECT_EQ(training::image_motion(camera, {}, kCentre), 0);
}

TEST(PoseSolver, FindsWhereCamerasStandUpToWhatAllHaveInCommon) {
    const std::vector<stage::Camera> given = ring(12);
    const std::vector<PoseChange> truth = small_changes(given.size(), 3);
    const std::vector<PoseChange> still(given.size());
    const double before = image_error(given, still, truth);
    EXPECT_GT(before, 0.7);
    const std::vector<PoseChange> found = rounds(given, still, truth, 60);
    // What is left is one motion of the whole world, which no image shows.
    EXPECT_LT(image_error(given, found, truth), 0.5 * before);
    // Truths without a common motion are found as a whole.
    EXPECT_LT(image_error(given, rounds(given, still, found, 60), found), 0.05 * before);
}

TEST(PoseSolver, AMotionOfTheWholeRigIsTakenOut) {
    const std::vector<stage::Camera> given = ring(9);
    std::vector<PoseChange> common(given.size());
    const glm::dvec3 shift(0.01, -0.004, 0.006);
    for (size_t i = 0; i < given.size(); ++i) {
        const glm::dvec3 own = glm::transpose(glm::dmat3(given[i].world_from_camera)) * shift;
        for (int axis = 0; axis < 3; ++axis) common[i][static_cast<size_t>(training::kShiftX + axis)] = own[axis];
    }
    const std::vector<PoseChange> still(given.size());
    EXPECT_GT(image_error(given, common, still), 0.5);
    // Images are the same before and after such a motion: there is evidence that the cameras stand as they should.
    EXPECT_LT(image_error(given, rounds(given, common, common, 1), still), 0.02);
}

TEST(PoseSolver, CamerasWithoutEvidenceAndRigsOfOneCameraStayFinite) {
    for (const uint32_t count : {1u, 2u, 6u}) {
        std::vector<stage::Camera> given = ring(count);
        if (count == 6)
            for (stage::Camera& camera : given) camera = given[0];  // all at one place
        const std::vector<PoseChange> changes = small_changes(count, 5);
        const std::vector<training::PoseEvidence> none(count);
        for (const PoseChange& change : training::next_poses(given, changes, none, kCentre, 1))
            for (const double number : change) EXPECT_LT(std::abs(number), 0.1);
    }
}

TEST(PoseSolver, StaysWithinBounds) {
    const std::vector<stage::Camera> given = ring(8);
    std::vector<PoseChange> truth(given.size()), still(given.size());
    truth[3][training::kTurnY] = 0.1;  // 6 degrees: not a calibration's error but another camera
    const std::vector<PoseChange> found = rounds(given, still, truth, 80);
    const PoseChange bounds = training::pose_bounds(given[3], kCentre);
    for (size_t i = 0; i < kPoseNumbers; ++i) EXPECT_LE(std::abs(found[3][i]), bounds[i]);
    EXPECT_TRUE(training::is_at_bound(found[3], bounds));
    EXPECT_FALSE(training::is_at_bound(found[0], training::pose_bounds(given[0], kCentre)));
}

}  // namespace
}  // namespace neuvv::test

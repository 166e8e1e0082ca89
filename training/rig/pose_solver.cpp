#include "training/rig/pose_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::training {

namespace {

constexpr size_t kCommon = 7;  // a turn, a motion and a scaling of the world
using CommonMotion = std::array<double, kCommon>;

template <size_t N>
using Matrix = std::array<std::array<double, N>, N>;

// How wrong a calibration may be, as standard deviations: radians; the share of the distance from the scene; of the
// focal length.
constexpr double kTurnPrior = 0.004, kShiftPrior = 0.001, kZoomPrior = 0.001;

// Neighbouring pixels err in the same way, as the field does. So many of them count as one.
constexpr double kAlikePixels = 10;

constexpr double kLeastError = 1e-6;  // the mean squared residual below which images agree as well as they can

// The share of each change that is made: a single round sees few pixels, and rounds average what they say.
constexpr double kGain = 0.4;

// Added to the diagonal of normal equations, relative to its mean: cameras that all stand at one place leave some of
// the seven numbers of a common motion undetermined, and a sphere its turns.
constexpr double kCommonRidge = 1e-9, kRidge = 1e-4;

// Solves a system whose matrix is symmetric and positive definite, by Cholesky's decomposition.
template <size_t N>
std::array<double, N> solved(Matrix<N> matrix, std::array<double, N> right) {
    for (size_t j = 0; j < N; ++j) {
        for (size_t k = 0; k < j; ++k)
            for (size_t i = j; i < N; ++i) matrix[i][j] -= matrix[i][k] * matrix[j][k];
        const double pivot = std::sqrt(matrix[j][j]);
        for (size_t i = j; i < N; ++i) matrix[i][j] /= pivot;
    }
    for (size_t i = 0; i < N; ++i) {
        for (size_t k = 0; k < i; ++k) right[i] -= matrix[i][k] * right[k];
        right[i] /= matrix[i][i];
    }
    for (size_t i = N; i-- > 0;) {
        for (size_t k = i + 1; k < N; ++k) right[i] -= matrix[k][i] * right[k];
        right[i] /= matrix[i][i];
    }
    return right;
}

// How turning, moving and scaling the world about `centre` changes a camera's numbers, to first order.
std::array<PoseChange, kCommon> common_motions(const stage::Camera& camera, glm::dvec3 centre) {
    const glm::dmat3 camera_from_world = glm::transpose(glm::dmat3(camera.world_from_camera));
    const glm::dvec3 arm = glm::dvec3(camera.world_from_camera[3]) - centre;
    const auto numbers = [&](glm::dvec3 turn, glm::dvec3 shift) {
        const glm::dvec3 t = camera_from_world * turn, s = camera_from_world * shift;
        return PoseChange{t.x, t.y, t.z, s.x, s.y, s.z, 0};
    };
    std::array<PoseChange, kCommon> motions;
    for (int i = 0; i < 3; ++i) {
        glm::dvec3 axis(0);
        axis[i] = 1;
        motions[static_cast<size_t>(i)] = numbers(axis, glm::cross(axis, arm));
        motions[static_cast<size_t>(i) + 3] = numbers(glm::dvec3(0), axis);
    }
    motions[6] = numbers(glm::dvec3(0), arm);
    return motions;
}

// The change of a camera, beyond `change`, that the images and the prior prefer.
PoseChange preferred(const stage::Camera& camera, const PoseEvidence& evidence, const PoseChange& change,
                     glm::dvec3 centre) {
    const double shift = kShiftPrior * distance_to(camera, centre);
    const PoseChange deviations{kTurnPrior, kTurnPrior, kTurnPrior, shift, shift, shift, kZoomPrior};
    const double variance = std::max(evidence.error / std::max(evidence.count, 1.0), kLeastError);
    const double scale = 1 / (kAlikePixels * variance);
    Matrix<kPoseNumbers> matrix;
    PoseChange right;
    for (size_t i = 0; i < kPoseNumbers; ++i) {
        const double prior = 1 / (deviations[i] * deviations[i]);
        for (size_t j = 0; j < kPoseNumbers; ++j) matrix[i][j] = scale * evidence.normal[i][j];
        matrix[i][i] += prior;
        right[i] = scale * evidence.right[i] - prior * change[i];
    }
    return solved(matrix, right);
}

// The motion of the world that moves its images as the changes do on average, in the sense of least squares over points
// around the centre and all cameras.
CommonMotion common_part(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& changes,
                         glm::dvec3 centre) {
    constexpr double kTiny = 1e-4;  // of a difference
    Matrix<kCommon> normal{};
    CommonMotion right{};
    for (size_t c = 0; c < given.size(); ++c) {
        const stage::Camera changed = moved(given[c], changes[c]);
        std::array<PoseChange, kCommon> motions = common_motions(given[c], centre);
        std::array<stage::Camera, kCommon> by;
        for (size_t j = 0; j < kCommon; ++j) {
            for (double& number : motions[j]) number *= kTiny;
            by[j] = moved(given[c], motions[j]);
        }
        for (const glm::dvec3& point : scene_points(given[c], centre)) {
            const glm::dvec2 at = seen_at(given[c], point), error = seen_at(changed, point) - at;
            std::array<glm::dvec2, kCommon> slope;
            for (size_t j = 0; j < kCommon; ++j) slope[j] = (seen_at(by[j], point) - at) / kTiny;
            for (size_t j = 0; j < kCommon; ++j) {
                right[j] += glm::dot(slope[j], error);
                for (size_t k = 0; k < kCommon; ++k) normal[j][k] += glm::dot(slope[j], slope[k]);
            }
        }
    }
    double trace = 0;
    for (size_t j = 0; j < kCommon; ++j) trace += normal[j][j];
    for (size_t j = 0; j < kCommon; ++j) normal[j][j] += kCommonRidge * trace / kCommon;
    return solved(normal, right);
}

}  // namespace

void PoseEvidence::add(double residual, const PoseChange& derivatives, double weight) {
    for (size_t i = 0; i < kPoseNumbers; ++i) {
        right[i] -= weight * derivatives[i] * residual;
        for (size_t j = 0; j < kPoseNumbers; ++j) normal[i][j] += weight * derivatives[i] * derivatives[j];
    }
    error += weight * residual * residual;
    count += 1;
}

PoseChange solution_of(const PoseEvidence& evidence) {
    Matrix<kPoseNumbers> normal = evidence.normal;
    double trace = 0;
    for (size_t i = 0; i < kPoseNumbers; ++i) trace += normal[i][i];
    if (trace == 0) return {};
    for (size_t i = 0; i < kPoseNumbers; ++i) normal[i][i] += kRidge * trace / double{kPoseNumbers};
    return solved(normal, evidence.right);
}

std::vector<PoseChange> next_poses(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& changes,
                                   const std::vector<PoseEvidence>& evidence, glm::dvec3 centre, double pixels) {
    assert(given.size() == changes.size() && given.size() == evidence.size() && "one of each by camera");
    std::vector<PoseChange> next = changes;
    for (size_t camera = 0; camera < given.size(); ++camera) {
        const PoseChange change = preferred(given[camera], evidence[camera], changes[camera], centre);
        const PoseChange steps = pose_steps(given[camera], centre, 2 * pixels);
        for (size_t i = 0; i < kPoseNumbers; ++i) next[camera][i] += kGain * std::clamp(change[i], -steps[i], steps[i]);
    }
    const CommonMotion common = common_part(given, next, centre);
    for (size_t camera = 0; camera < given.size(); ++camera) {
        const std::array<PoseChange, kCommon> motions = common_motions(given[camera], centre);
        const PoseChange bounds = pose_bounds(given[camera], centre);
        for (size_t i = 0; i < kPoseNumbers; ++i) {
            for (size_t j = 0; j < kCommon; ++j) next[camera][i] -= common[j] * motions[j][i];
            next[camera][i] = std::clamp(next[camera][i], -bounds[i], bounds[i]);
        }
    }
    return next;
}

}  // namespace neuvv::training

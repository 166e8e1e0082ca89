#include "motion/video/bundle.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "base/error.h"
#include "motion/skeleton/median.h"
#include "motion/video/triangulate.h"

namespace neuvv::motion {

namespace {

constexpr double kPointError = 0.01;  // of the body's height: what detectors reach
constexpr double kLeastError = 0.001;
constexpr double kHuber = 0.02;       // of the height: a key point further off pulls no harder
constexpr double kBoneError = 0.004;  // of the height: limbs
constexpr double kTrunkError = 0.03;  // of the height: bones across joints that shift and bend
constexpr double kAcceleration = 15;  // metres a second²: usual in a dance
// Frames a second for which these two hold. What they say of a motion counts by its seconds, so that each of more
// frames says less.
constexpr double kUsualRate = 25;
constexpr int kMaxIterations = 50;

// Adds the absolute fourth differences of a series to a list; NaN: not known. A moving body hardly has any, but
// independent errors have them √70-fold. Each is multiplied by the weight of the value in its middle.
void add_differences(const std::vector<double>& values, const std::vector<double>& weights,
                     std::vector<double>& differences) {
    for (size_t i = 4; i < values.size(); ++i) {
        const double* v = &values[i - 4];
        const double difference = v[0] - 4 * v[1] + 6 * v[2] - 4 * v[3] + v[4];
        if (std::isfinite(difference)) differences.push_back(std::abs(difference) * weights[i - 2]);
    }
}

constexpr double kMedianOfNormal = 0.6745;  // of absolute values, in deviations

double noise_of(std::vector<double>& differences) {
    return median(differences) / (kMedianOfNormal * std::sqrt(70.0));
}

// The image of a joint against a key point.
struct ReprojectionResidual {
    const stage::Camera& camera;
    glm::dvec2 pixel;
    double scale;  // errors a pixel

    template <typename T>
    bool operator()(const T* point, T* residual) const {
        const glm::dmat4& pose = camera.world_from_camera;
        T local[3];
        for (int axis = 0; axis < 3; ++axis) {
            local[axis] = T(0);
            for (int i = 0; i < 3; ++i) local[axis] += pose[axis][i] * (point[i] - pose[3][i]);
        }
        if (!(local[2] < T(-1e-6))) return false;
        residual[0] = scale * (camera.cx - camera.fx * local[0] / local[2] - pixel.x);
        residual[1] = scale * (camera.cy + camera.fy * local[1] / local[2] - pixel.y);
        return true;
    }
};

struct BoneResidual {
    double scale;

    template <typename T>
    bool operator()(const T* parent, const T* child, const T* length, T* residual) const {
        T square(1e-12);  // the root of 0 has no derivative
        for (int i = 0; i < 3; ++i) square += (child[i] - parent[i]) * (child[i] - parent[i]);
        using std::sqrt;
        residual[0] = scale * (sqrt(square) - length[0]);
        return true;
    }
};

struct AccelerationResidual {
    double scale;

    template <typename T>
    bool operator()(const T* before, const T* now, const T* after, T* residual) const {
        for (int i = 0; i < 3; ++i) residual[i] = scale * (before[i] - 2.0 * now[i] + after[i]);
        return true;
    }
};

// Whether the bone to this joint is one of a limb, which keeps its length.
bool is_rigid(size_t joint) {
    const JointInfo& info = info_of(joint_at(joint));
    return info.limb != Limb::kTrunk && info.limb != Limb::kHead;
}

struct BundleProblem {
    ceres::Problem problem;
    std::array<double, kJoints> lengths;
};

// By how much the key points err from frame to frame, metres at the joint: only such errors can be smoothed away.
double point_noise(const Detections& detections, const UsedPoints& used, double height_m, const SkeletonClip& clip) {
    constexpr size_t kEnough = 100;
    std::vector<double> differences, pixels(clip.frames.size()), weights(clip.frames.size());
    for (size_t c = 0; c < detections.cameras.size(); ++c)
        for (size_t j = 0; j < kJoints; ++j)
            for (int axis = 0; axis < 2; ++axis) {
                for (size_t f = 0; f < clip.frames.size(); ++f) {
                    const KeyPoint& point = detections.in(f, c)[j];
                    pixels[f] = used[f * detections.cameras.size() + c][j] ? point.pixel[axis] : NAN;
                    weights[f] = metres_per_pixel(detections.cameras[c], clip.frames[f][j].position) *
                                 std::sqrt(point.confidence);
                }
                add_differences(pixels, weights, differences);
            }
    const double usual = kPointError * height_m;
    return differences.size() < kEnough ? usual : std::clamp(noise_of(differences), kLeastError * height_m, usual);
}

void add_reprojections(BundleProblem& bundle, const Detections& detections, const UsedPoints& used, double height_m,
                       SkeletonClip& clip) {
    const double noise = point_noise(detections, used, height_m, clip);
    for (size_t f = 0; f < clip.frames.size(); ++f) {
        for (size_t c = 0; c < detections.cameras.size(); ++c) {
            const size_t image = f * detections.cameras.size() + c;
            for (size_t j = 0; j < kJoints; ++j) {
                if (!used[image][j]) continue;
                const stage::Camera& camera = detections.cameras[c];
                const KeyPoint& point = detections.points[image][j];
                glm::dvec3& position = clip.frames[f][j].position;
                const double scale = metres_per_pixel(camera, position) / noise;
                bundle.problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<ReprojectionResidual, 2, 3>(
                        new ReprojectionResidual{camera, point.pixel, scale * std::sqrt(point.confidence)}),
                    new ceres::HuberLoss(kHuber * height_m / noise), &position[0]);
            }
        }
    }
}

// How much the length of the bone to a joint varies beyond noise, metres: detectors see joints elsewhere in other
// postures and from other sides, and calibrations err.
double length_variation(size_t joint, const SkeletonClip& clip) {
    const size_t parent = index_of(info_of(joint_at(joint)).parent);
    std::vector<double> lengths(clip.frames.size(), NAN), differences, known;
    for (size_t f = 0; f < clip.frames.size(); ++f) {
        const JointSample &from = clip.frames[f][parent], &to = clip.frames[f][joint];
        if (!from.measured || !to.measured) continue;
        lengths[f] = glm::distance(from.position, to.position);
        known.push_back(lengths[f]);
    }
    add_differences(lengths, std::vector<double>(lengths.size(), 1), differences);
    const double usual = median(known);
    for (double& length : known) length = std::abs(length - usual);
    const double spread = median(known) / kMedianOfNormal, noise = noise_of(differences);
    return std::sqrt(std::max(0.0, spread * spread - noise * noise));
}

double share_of_frame(const SkeletonClip& clip) {
    return std::sqrt(kUsualRate / clip.fps);
}

void add_bones(BundleProblem& bundle, double height_m, SkeletonClip& clip) {
    for (size_t j = 1; j < kJoints; ++j) {
        const size_t parent = index_of(info_of(joint_at(j)).parent);
        if (!(bundle.lengths[j] > 0)) continue;
        const double error = (is_rigid(j) ? kBoneError : kTrunkError) * height_m;
        const double scale = share_of_frame(clip) / std::hypot(error, length_variation(j, clip));
        for (Pose& pose : clip.frames)
            bundle.problem.AddResidualBlock(
                new ceres::AutoDiffCostFunction<BoneResidual, 1, 3, 3, 1>(new BoneResidual{scale}), nullptr,
                &pose[parent].position[0], &pose[j].position[0], &bundle.lengths[j]);
    }
}

void add_accelerations(BundleProblem& bundle, const std::array<double, kJoints>& known, SkeletonClip& clip) {
    const double scale = share_of_frame(clip) * clip.fps * clip.fps / kAcceleration;
    for (size_t j = 0; j < kJoints; ++j) {
        if (!(known[j] > 0)) continue;
        for (size_t f = 1; f + 1 < clip.frames.size(); ++f)
            bundle.problem.AddResidualBlock(
                new ceres::AutoDiffCostFunction<AccelerationResidual, 3, 3, 3, 3>(new AccelerationResidual{scale}),
                nullptr, &clip.frames[f - 1][j].position[0], &clip.frames[f][j].position[0],
                &clip.frames[f + 1][j].position[0]);
    }
}

}  // namespace

void fit_over_time(const Detections& detections, const UsedPoints& used, double height_m, SkeletonClip& clip) {
    BundleProblem bundle;
    bundle.lengths = bone_lengths(clip);
    std::array<double, kJoints> known{};
    for (const Pose& pose : clip.frames)
        for (size_t j = 0; j < kJoints; ++j) known[j] = std::max(known[j], pose[j].confidence);
    add_reprojections(bundle, detections, used, height_m, clip);
    add_bones(bundle, height_m, clip);
    add_accelerations(bundle, known, clip);

    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = kMaxIterations;
    options.function_tolerance = 1e-5;
    options.num_threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &bundle.problem, &summary);
    if (!summary.IsSolutionUsable())
        throw RuntimeFailure(fmt::format("skeleton: the fit over time failed: {}", summary.message));
}

}  // namespace neuvv::motion

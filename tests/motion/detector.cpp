#include "motion/detector.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <stdexcept>

#include "motion/skeleton/model_motion.h"
#include "motion/video/triangulate.h"
#include "support/look_at.h"
#include "support/temporary_folder.h"

namespace neuvv::test {

namespace {

using motion::Joint;
using motion::kJoints;

struct Box {
    glm::dvec3 low{INFINITY}, high{-INFINITY};
};

Box box_of(const motion::SkeletonClip& clip) {
    Box box;
    for (const motion::Pose& pose : clip.frames)
        for (const motion::JointSample& sample : pose) {
            box.low = glm::min(box.low, sample.position);
            box.high = glm::max(box.high, sample.position);
        }
    return box;
}

void swap_sides(motion::KeyPoints& points, const std::vector<Joint>& right_side) {
    for (const Joint right : right_side)
        std::swap(points[motion::index_of(right)], points[motion::index_of(motion::info_of(right).mirrored)]);
}

}  // namespace

std::vector<stage::Camera> cameras_around(const motion::SkeletonClip& clip, size_t count) {
    const Box box = box_of(clip);
    const glm::dvec3 centre = 0.5 * (box.low + box.high);
    const double distance = 2.5 * glm::length(box.high - box.low);
    std::vector<stage::Camera> cameras;
    for (size_t i = 0; i < count; ++i) {
        const double turn = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
        const double up = i % 2 == 0 ? 0.1 : 0.5;
        const glm::dvec3 outward(std::cos(up) * std::sin(turn), std::sin(up), std::cos(up) * std::cos(turn));
        cameras.push_back(look_at(centre + distance * outward, centre, 512, 512, 2.2));
    }
    return cameras;
}

Detected detect_counting(const motion::SkeletonClip& clip, const std::vector<stage::Camera>& cameras,
                         const DetectorErrors& errors, uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    const double height = height_of(clip);
    Detected result;
    motion::Detections& seen = result.seen;
    seen.cameras = cameras;
    seen.frames = clip.frames.size();
    seen.fps = clip.fps;
    seen.points.resize(seen.frames * cameras.size());
    for (size_t f = 0; f < seen.frames; ++f)
        for (size_t c = 0; c < cameras.size(); ++c) {
            motion::KeyPoints& points = seen.in(f, c);
            for (size_t j = 0; j < kJoints; ++j) {
                const glm::dvec3 joint = clip.frames[f][j].position;
                const double pixels = errors.noise * height / motion::metres_per_pixel(cameras[c], joint);
                points[j].pixel =
                    *motion::project(cameras[c], joint) + pixels * glm::dvec2(normal(random), normal(random));
                points[j].confidence = 0.5 + 0.5 * uniform(random);
                if (uniform(random) < errors.outliers)
                    points[j].pixel = {cameras[c].width * uniform(random), cameras[c].height * uniform(random)};
                if (uniform(random) < errors.dropped) points[j].confidence = 0;
            }
            using enum Joint;
            const std::vector<Joint> arm = {kRightShoulder, kRightElbow, kRightWrist};
            const std::vector<Joint> leg = {kRightHip,  kRightKnee,   kRightAnkle,
                                            kRightHeel, kRightBigToe, kRightSmallToe};
            for (const std::vector<Joint>& limb : {arm, leg}) {
                if (!(uniform(random) < errors.swapped)) continue;
                swap_sides(points, limb);
                ++result.swapped;
            }
        }
    return result;
}

motion::Detections detect(const motion::SkeletonClip& clip, const std::vector<stage::Camera>& cameras,
                          const DetectorErrors& errors, uint32_t seed) {
    return detect_counting(clip, cameras, errors, seed).seen;
}

motion::SkeletonClip motion_of(const stage::GltfScene& scene, size_t frames) {
    std::vector<double> times;
    for (size_t f = 0; f < frames; ++f) times.push_back(static_cast<double>(f) / 25);
    return motion::model_motion(scene, 0, times, 25);
}

motion::SkeletonClip performer_motion(size_t frames) {
    static const stage::GltfScene scene = stage::load_gltf(NEUVV_SOURCE_DIR "/tools/performer/performer.glb");
    return motion_of(scene, frames);
}

const motion::SkeletonClip& squats_motion() {
    static const motion::SkeletonClip clip = [] {
        const TemporaryFolder folder;
        const auto made = folder.path / "squats.glb";
        const std::string command =
            "python3 '" NEUVV_SOURCE_DIR "/tools/performer/make_performer.py' --squats '" + made.string() + "'";
        if (std::system("python3 -c 'import zlib' > /dev/null 2>&1") != 0) return motion::SkeletonClip{};
        if (std::system(command.c_str()) != 0) throw std::runtime_error(command + ": failed");
        return motion_of(stage::load_gltf(made), 100);
    }();
    return clip;
}

double height_of(const motion::SkeletonClip& clip) {
    return motion::body_height(motion::bone_lengths(clip));
}

ClipError error_of(const motion::SkeletonClip& clip, const motion::SkeletonClip& truth) {
    const double height = height_of(truth);
    std::array<double, kJoints> sums{};
    ClipError error;
    for (size_t f = 0; f < truth.frames.size(); ++f) {
        bool swapped = false;
        for (size_t j = 0; j < kJoints; ++j) {
            const glm::dvec3 found = clip.frames[f][j].position;
            const size_t other = motion::index_of(motion::info_of(motion::joint_at(j)).mirrored);
            sums[j] += glm::distance(found, truth.frames[f][j].position) / height;
            swapped |= other != j && glm::distance(found, truth.frames[f][other].position) <
                                         glm::distance(found, truth.frames[f][j].position);
        }
        error.swapped_frames += swapped;
    }
    for (double& sum : sums) {
        sum /= static_cast<double>(truth.frames.size());
        error.mean += sum / kJoints;
        error.worst_joint = std::max(error.worst_joint, sum);
    }
    return error;
}

}  // namespace neuvv::test

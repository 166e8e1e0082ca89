// Skeletons from key points: the truth is a model's own motion, the key points are its joints as detectors see them.
#include "motion/video/extract.h"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>
#include <random>

#include "motion/compare/compare.h"
#include "motion/detector.h"
#include "motion/skeleton/model_motion.h"
#include "motion/video/triangulate.h"
#include "support/input_error.h"
#include "support/near.h"

namespace neuvv {
namespace {

constexpr size_t kViews = 14;

// The bar is 2 % of the height; what the fit reaches is asked for, so that it does not get worse unseen.
constexpr double kMeanError = 0.006;

const motion::SkeletonClip& truth() {
    static const motion::SkeletonClip clip = test::performer_motion(75);
    return clip;
}

motion::Extraction extract(const motion::Detections& seen, bool bundle = true) {
    return motion::extract_skeleton(seen, {bundle});
}

TEST(Triangulate, FindsThePointThatViewsAgreeOn) {
    const auto cameras = test::cameras_around(truth(), 6);
    const glm::dvec3 point(0.2, 1.1, -0.1);
    std::vector<motion::KeyPoint> seen;
    for (const stage::Camera& camera : cameras) seen.push_back({*motion::project(camera, point), 1});
    seen[1].pixel += glm::dvec2(60, -20);
    seen[4].confidence = 0;
    const auto found = motion::triangulate(cameras, seen, 0.03);
    ASSERT_TRUE(found);
    test::expect_near(found->position, point, 1e-9);
    EXPECT_EQ(found->views, 4u);
    EXPECT_EQ(found->agrees, (std::vector<bool>{true, false, true, true, false, true}));
}

// The point of two views errs more than that of all, from which no view is far.
TEST(Triangulate, KeepsViewsThatAllOthersAgreeWith) {
    constexpr double kTolerance_m = 0.03;
    constexpr int kTrials = 300;
    const auto cameras = test::cameras_around(truth(), 4);
    const glm::dvec3 point(0.2, 1.1, -0.1);
    std::mt19937 random(1);
    std::normal_distribution<double> normal(0, 0.5 * kTolerance_m);
    int complete = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<motion::KeyPoint> seen;
        for (const stage::Camera& camera : cameras) {
            const glm::dvec2 error = glm::dvec2(normal(random), normal(random));
            seen.push_back({*motion::project(camera, point) + error / motion::metres_per_pixel(camera, point), 1});
        }
        const auto found = motion::triangulate(cameras, seen, kTolerance_m);
        complete += found && found->views == cameras.size();
    }
    EXPECT_GT(complete, 0.85 * kTrials);
}

TEST(Triangulate, NeedsTwoViewsThatAgree) {
    const auto cameras = test::cameras_around(truth(), 3);
    std::vector<motion::KeyPoint> seen(3);
    EXPECT_FALSE(motion::triangulate(cameras, seen, 0.03));
    seen[0] = {*motion::project(cameras[0], glm::dvec3(0, 1, 0)), 1};
    EXPECT_FALSE(motion::triangulate(cameras, seen, 0.03));
    seen[1] = {*motion::project(cameras[1], glm::dvec3(0, 1.3, 0)), 1};
    EXPECT_FALSE(motion::triangulate(cameras, seen, 0.03));
    seen[1] = {*motion::project(cameras[1], glm::dvec3(0, 1, 0)), 1};
    EXPECT_TRUE(motion::triangulate(cameras, seen, 0.03));
}

TEST(Extract, CleanKeyPointsGiveTheMotionBack) {
    const auto seen = test::detect(truth(), test::cameras_around(truth(), kViews), {0, 0, 0, 0}, 1);
    const motion::Extraction found = extract(seen, false);
    EXPECT_LT(test::error_of(found.clip, truth()).worst_joint, 1e-6);
    EXPECT_EQ(found.quality.swapped, 0u);
    EXPECT_EQ(found.quality.outliers, 0u);
    // The fit bends the motion by what it assumes of bones and accelerations.
    EXPECT_LT(test::error_of(extract(seen).clip, truth()).worst_joint, 0.002);
}

void expect_survival(const motion::SkeletonClip& truth, const char* title) {
    for (const uint32_t seed : {1u, 2u, 3u}) {
        const auto [seen, swapped] = test::detect_counting(truth, test::cameras_around(truth, kViews), {}, seed);
        const motion::Extraction fitted = extract(seen), each = extract(seen, false);
        const test::ClipError with = test::error_of(fitted.clip, truth), without = test::error_of(each.clip, truth);
        std::printf(
            "%s, seed %u: mean error %.2f %% of the height (worst joint %.2f %%), without the fit %.2f %% (%.2f %%)\n",
            title, seed, 100 * with.mean, 100 * with.worst_joint, 100 * without.mean, 100 * without.worst_joint);
        EXPECT_LT(with.mean, kMeanError);
        EXPECT_LT(with.mean, without.mean);
        EXPECT_EQ(with.swapped_frames, 0u);
        EXPECT_NEAR(fitted.quality.height_m, test::height_of(truth), 0.03 * test::height_of(truth));
        EXPECT_NEAR(static_cast<double>(fitted.quality.swapped), static_cast<double>(swapped), 0.03 * double(swapped));
    }
}

TEST(Extract, SurvivesADetectorsErrors) {
    expect_survival(truth(), "dance");
}

// A figure of other proportions and another motion.
TEST(Extract, SurvivesADetectorsErrorsOnAnotherBody) {
    if (test::squats_motion().frames.empty()) GTEST_SKIP() << "python3 is not installed";
    expect_survival(test::squats_motion(), "squats");
}

// What a real capture has beside noise: cameras that are calibrated a little wrong, and a detector that sees each joint
// elsewhere from each side. These errors last, so that no fit over time removes them, and bones seem to vary.
motion::Detections detect_with_bias(const motion::SkeletonClip& truth, uint32_t seed) {
    constexpr double kTurn = 0.006, kBias = 0.01;  // radians, of the height
    auto seen = test::detect(truth, test::cameras_around(truth, 4), {0.005, 0.05, 0, 0.01}, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (size_t c = 0; c < seen.cameras.size(); ++c) {
        for (size_t j = 0; j < motion::kJoints; ++j) {
            const glm::dvec2 bias = kBias * test::height_of(truth) * glm::dvec2(normal(random), normal(random));
            for (size_t f = 0; f < seen.frames; ++f)
                seen.in(f, c)[j].pixel += bias / motion::metres_per_pixel(seen.cameras[c], truth.frames[f][j].position);
        }
        const glm::dvec3 turn = kTurn * glm::dvec3(normal(random), normal(random), normal(random));
        glm::dmat4& pose = seen.cameras[c].world_from_camera;
        pose *= glm::mat4_cast(glm::angleAxis(glm::length(turn), glm::normalize(turn)));
    }
    return seen;
}

TEST(Extract, TheFitIsNoWorseThanSingleFramesWhereErrorsLast) {
    const stage::GltfScene scene = stage::load_gltf(NEUVV_SOURCE_DIR "/tools/performer/performer.glb");
    for (const double fps : {25.0, 60.0}) {
        std::vector<double> times;
        for (size_t f = 0; f < 100; ++f) times.push_back(double(f) / fps);
        const motion::SkeletonClip moving = motion::model_motion(scene, 0, times, fps);
        for (const uint32_t seed : {1u, 2u, 3u}) {
            const motion::Detections seen = detect_with_bias(moving, seed);
            const double with = test::error_of(extract(seen).clip, moving).mean;
            const double without = test::error_of(extract(seen, false).clip, moving).mean;
            std::printf("%.0f fps, seed %u: mean error %.2f %% of the height, without the fit %.2f %%\n", fps, seed,
                        100 * with, 100 * without);
            EXPECT_LT(with, without);
        }
    }
}

TEST(Extract, WhatNoViewShowsIsGuessedAndSaidToBe) {
    auto seen = test::detect(truth(), test::cameras_around(truth(), kViews), {0.002, 0, 0, 0}, 1);
    const size_t wrist = motion::index_of(motion::Joint::kLeftWrist);
    for (size_t f = 30; f < 34; ++f)
        for (size_t c = 0; c < kViews; ++c) seen.in(f, c)[wrist].confidence = 0;
    const motion::Extraction found = extract(seen);
    EXPECT_NEAR(found.quality.known[wrist], 71.0 / 75, 1e-9);
    for (size_t f = 0; f < 75; ++f) {
        const bool hidden = f >= 30 && f < 34;
        EXPECT_EQ(found.clip.frames[f][wrist].measured, !hidden) << f;
        const double off = glm::distance(found.clip.frames[f][wrist].position, truth().frames[f][wrist].position);
        EXPECT_LT(off, hidden ? 0.15 : 0.02) << f;
    }
}

// What COCO-17 sees is enough to compare arms, legs and trunk.
TEST(Extract, ADetectorWithoutFeetGivesALimbsDirections) {
    auto seen = test::detect(truth(), test::cameras_around(truth(), kViews), {0.002, 0, 0, 0}, 1);
    for (const motion::Joint joint :
         {motion::Joint::kLeftHeel, motion::Joint::kLeftBigToe, motion::Joint::kLeftSmallToe, motion::Joint::kRightHeel,
          motion::Joint::kRightBigToe, motion::Joint::kRightSmallToe}) {
        for (motion::KeyPoints& points : seen.points) points[motion::index_of(joint)] = {};
        seen.lacking[motion::index_of(joint)] = true;
    }
    const motion::Extraction found = extract(seen);
    EXPECT_EQ(motion::at(found.clip.frames[0], motion::Joint::kLeftHeel).confidence, 0);
    const motion::Comparison comparison = motion::compare(truth(), found.clip);
    for (const double score : comparison.limb_scores) EXPECT_GT(score, 99);
}

TEST(Extract, TheSizeOfABodyIsGuessedFromOneSide) {
    auto cameras = test::cameras_around(truth(), 24);
    cameras.resize(5);  // a sixth of a turn
    const auto found = extract(test::detect(truth(), cameras, {}, 4));
    EXPECT_LT(test::error_of(found.clip, truth()).mean, 0.02);
    EXPECT_NEAR(found.quality.height_m, test::height_of(truth()), 0.05);
}

TEST(Extract, RefusesKeyPointsWithoutABody) {
    auto seen = test::detect(truth(), test::cameras_around(truth(), kViews), {}, 1);
    for (motion::KeyPoints& points : seen.points)
        for (motion::KeyPoint& point : points) point.confidence = 0;
    expect_input_error([&] { extract(seen); }, {"no frame shows a leg and a trunk"});
}

// A model whose vertices follow up to eight joints, of which the first four have no weight, has the same skeleton.
TEST(ModelMotion, SeesAllJointsOfAVertex) {
    stage::GltfScene scene = stage::load_gltf(NEUVV_SOURCE_DIR "/tools/performer/performer.glb");
    const motion::SkeletonClip expected = test::motion_of(scene, 2);
    std::vector<stage::GltfMesh> meshes(scene.meshes.begin(), scene.meshes.end());
    for (stage::GltfMesh& mesh : meshes)
        for (stage::GltfPrimitive& primitive : mesh.primitives) {
            if (primitive.joints.empty()) continue;
            std::vector<glm::u16vec4> joints;
            std::vector<glm::vec4> weights;
            for (size_t v = 0; v < primitive.positions.size(); ++v) {
                joints.insert(joints.end(), {glm::u16vec4(0), primitive.joints[v]});
                weights.insert(weights.end(), {glm::vec4(0), primitive.weights[v]});
            }
            primitive.joints = std::move(joints);
            primitive.weights = std::move(weights);
            primitive.joint_sets = 2;
        }
    scene.meshes = std::move(meshes);
    const motion::SkeletonClip seen = test::motion_of(scene, 2);
    for (size_t f = 0; f < expected.frames.size(); ++f)
        for (size_t j = 0; j < expected.frames[f].size(); ++j)
            EXPECT_EQ(seen.frames[f][j].position, expected.frames[f][j].position);
}

}  // namespace
}  // namespace neuvv

// What a trainee does otherwise is named; what is only another body, place, direction or speed is not.
#include "motion/compare/compare.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/trainee.h"
#include "motion/video/best_view.h"
#include "reference/motion.h"
#include "support/input_error.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

using motion::Limb;
using motion::MistakeKind;

constexpr const char* kRecordedTrainee = NEUVV_SOURCE_DIR "/tools/performer/trainee.glb";

const motion::SkeletonClip& trainer() {
    static const motion::SkeletonClip clip = test::performer_motion(75);
    return clip;
}

std::string all_of(const motion::Comparison& comparison) {
    std::string text;
    for (const motion::Mistake& mistake : comparison.mistakes) text += text_of(mistake) + "\n";
    return fmt::format("score {:.1f}\n{}", comparison.score, text);
}

// A correct performance of another body, elsewhere, seen by a camera that errs by a centimetre.
motion::SkeletonClip another(const motion::SkeletonClip& clip, uint32_t seed = 7) {
    return test::with_noise(test::other_body(clip, 0.85, {3, 0, -1}, 2.1), 0.01, seed);
}

// Both figures; the second one only where its generator runs.
std::vector<motion::SkeletonClip> trainers() {
    std::vector<motion::SkeletonClip> clips = {trainer()};
    if (!test::squats_motion().frames.empty()) clips.push_back(test::squats_motion());
    return clips;
}

TEST(Compare, TheSameMotionIsPerfect) {
    const motion::Comparison same = motion::compare(trainer(), trainer());
    EXPECT_DOUBLE_EQ(same.score, 100);
    EXPECT_TRUE(same.mistakes.empty()) << all_of(same);
    for (size_t f = 0; f < 75; ++f) {
        EXPECT_EQ(same.trainer_frame[f], static_cast<double>(f));
        for (const double error : same.errors[f]) EXPECT_NEAR(error, 0, 1e-5);
    }
}

TEST(Compare, AnotherBodyAt90PercentSpeedScores95) {
    for (const motion::SkeletonClip& clip : trainers()) {
        const motion::Comparison found = motion::compare(clip, another(test::at_speed(clip, 0.9)));
        std::printf("correct, 90 %% speed, bones 15 %% shorter, elsewhere, noise 1 cm: %s", all_of(found).c_str());
        EXPECT_GE(found.score, 95);
        EXPECT_TRUE(found.mistakes.empty()) << all_of(found);
        EXPECT_NEAR(std::remainder(found.yaw - 2.1, 2 * std::numbers::pi), 0, 0.03);
    }
}

TEST(Compare, NamesAnArmThatIsOff) {
    for (const motion::SkeletonClip& clip : trainers())
        for (const Limb arm : {Limb::kLeftArm, Limb::kRightArm})
            for (const uint32_t seed : {1u, 2u, 3u}) {
                const auto trainee = another(test::with_arm_off(clip, arm, 25, 1, 2), seed);
                const motion::Comparison found = motion::compare(clip, trainee);
                ASSERT_EQ(found.mistakes.size(), 1u) << all_of(found);
                EXPECT_EQ(found.mistakes[0].limb, arm);
                EXPECT_EQ(found.mistakes[0].kind, MistakeKind::kOff) << all_of(found);
                EXPECT_NEAR(found.mistakes[0].amount, 25, 3) << all_of(found);
                EXPECT_NEAR(found.mistakes[0].first_s, 1, 0.1);
                EXPECT_NEAR(found.mistakes[0].last_s, 2, 0.1);
            }
}

TEST(Compare, NamesALegThatIsLate) {
    for (const motion::SkeletonClip& clip : trainers())
        for (const Limb leg : {Limb::kLeftLeg, Limb::kRightLeg})
            for (const uint32_t seed : {1u, 2u, 3u}) {
                const auto trainee = another(test::with_late_leg(clip, leg, 0.4, 0, 4), seed);
                const motion::Comparison found = motion::compare(clip, trainee);
                ASSERT_GE(found.mistakes.size(), 1u) << all_of(found);
                for (const motion::Mistake& mistake : found.mistakes) {
                    EXPECT_EQ(mistake.limb, leg) << all_of(found);
                    EXPECT_EQ(mistake.kind, MistakeKind::kLate) << all_of(found);
                    EXPECT_NEAR(mistake.amount, 0.4, 0.05) << all_of(found);
                }
            }
}

TEST(Compare, NamesATurnToTheOtherSide) {
    const auto trainee = another(test::with_mirrored_turn(trainer(), test::facing_of(trainer()), 0.3, 1.4));
    const motion::Comparison found = motion::compare(trainer(), trainee);
    ASSERT_EQ(found.mistakes.size(), 1u) << all_of(found);
    EXPECT_EQ(found.mistakes[0].limb, Limb::kTrunk);
    EXPECT_EQ(found.mistakes[0].kind, MistakeKind::kMirrored);
}

TEST(Compare, NamesAllThreeAndNothingElse) {
    auto trainee = test::with_arm_off(trainer(), Limb::kRightArm, 25, 1.8, 2.8);
    trainee = test::with_late_leg(trainee, Limb::kLeftLeg, 0.4, 0, 3);
    trainee = another(test::with_mirrored_turn(trainee, test::facing_of(trainer()), 0.3, 1.4));
    const motion::Comparison found = motion::compare(trainer(), trainee);
    std::printf("three planted mistakes: %s", all_of(found).c_str());
    std::array<bool, 3> named{};
    for (const motion::Mistake& mistake : found.mistakes) {
        const bool arm = mistake.limb == Limb::kRightArm && mistake.kind == MistakeKind::kOff;
        const bool leg = mistake.limb == Limb::kLeftLeg && mistake.kind == MistakeKind::kLate;
        const bool turn = mistake.limb == Limb::kTrunk && mistake.kind == MistakeKind::kMirrored;
        EXPECT_TRUE(arm || leg || turn) << text_of(mistake);
        named[0] |= arm, named[1] |= leg, named[2] |= turn;
    }
    EXPECT_TRUE(named[0] && named[1] && named[2]) << all_of(found);
}

// The recorded trainee of tools/performer, seen exactly and by a camera that errs: what its README.md says is named.
TEST(Compare, NamesWhatTheRecordedTraineeDoesWrong) {
    const motion::SkeletonClip recorded = motion::read_skeleton(kRecordedTrainee);
    for (const motion::SkeletonClip& trainee : {recorded, another(recorded, 1), another(recorded, 2)}) {
        const motion::Comparison found = motion::compare(trainer(), trainee);
        ASSERT_EQ(found.mistakes.size(), 2u) << all_of(found);
        const motion::Mistake &arm = found.mistakes[0], &leg = found.mistakes[1];
        EXPECT_EQ(arm.limb, Limb::kLeftArm);
        EXPECT_EQ(arm.kind, MistakeKind::kOff);
        EXPECT_NEAR(arm.amount, 28, 3) << all_of(found);
        EXPECT_NEAR(arm.first_s, 0.4, 0.15) << all_of(found);
        EXPECT_NEAR(arm.last_s, 1.4, 0.15) << all_of(found);
        EXPECT_EQ(leg.limb, Limb::kRightLeg);
        EXPECT_EQ(leg.kind, MistakeKind::kLate);
        EXPECT_NEAR(leg.amount, 0.4, 0.1) << all_of(found);
        EXPECT_GE(leg.first_s, 1.5) << all_of(found);
        EXPECT_LE(leg.last_s, 2.8) << all_of(found);
    }
    EXPECT_NEAR(test::height_of(recorded) / test::height_of(trainer()), 0.87, 0.02);
}

TEST(RecordedTrainee, TheScriptMakesTheFile) {
    if (std::system("python3 -c 'import zlib' > /dev/null 2>&1") != 0) GTEST_SKIP() << "python3 is not installed";
    const TemporaryFolder folder;
    const auto made = folder.path / "trainee.glb";
    const std::string command =
        "python3 '" NEUVV_SOURCE_DIR "/tools/performer/make_performer.py' --trainee '" + made.string() + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_TRUE(read_text(made) == read_text(kRecordedTrainee))
        << "run tools/performer/make_performer.py --trainee tools/performer/trainee.glb and commit the result";
}

TEST(Compare, LeavesOutWhatIsEstimatedOrNotCounted) {
    auto trainee = test::with_arm_off(trainer(), Limb::kLeftArm, 60, 0, 3);
    motion::CompareOptions options;
    options.counted[motion::index_of(Limb::kLeftArm)] = false;
    EXPECT_DOUBLE_EQ(motion::compare(trainer(), trainee, options).score, 100);
    for (motion::Pose& pose : trainee.frames)
        for (const motion::Joint joint : {motion::Joint::kLeftElbow, motion::Joint::kLeftWrist})
            motion::at(pose, joint).measured = false;
    const motion::Comparison found = motion::compare(trainer(), trainee);
    EXPECT_DOUBLE_EQ(found.score, 100);
    EXPECT_EQ(found.limb_scores[motion::index_of(Limb::kLeftArm)], -1);
    for (motion::Pose& pose : trainee.frames)
        for (motion::JointSample& sample : pose) sample.measured = false;
    expect_input_error([&] { motion::compare(trainer(), trainee); }, {"no limb"});
    options.counted.assign(motion::kLimbs, false);
    expect_input_error([&] { motion::compare(trainer(), trainer(), options); }, {"leave-out", "no limb"});
    // The trunk says how the trainee stands turned, counted or not.
    options.counted.assign(motion::kLimbs, true);
    options.counted[motion::index_of(Limb::kTrunk)] = false;
    EXPECT_NEAR(motion::compare(trainer(), test::other_body(trainer(), 1, {0, 0, 0}, 1), options).yaw, 1, 1e-6);
}

void hide(motion::SkeletonClip& clip, std::initializer_list<motion::Joint> joints, size_t from_frame = 0) {
    for (size_t f = from_frame; f < clip.frames.size(); ++f)
        for (const motion::Joint joint : joints) motion::at(clip.frames[f], joint) = {};
}

TEST(Compare, APoseThatIsHeldIsNoMotion) {
    motion::SkeletonClip one = trainer(), held = trainer();
    one.frames.resize(1);
    for (motion::Pose& pose : held.frames) pose = trainer().frames[20];
    for (const motion::SkeletonClip& still : {one, held, test::other_body(held, 0.8, {1, 0, 0}, 1)}) {
        expect_input_error([&] { motion::compare(still, trainer()); }, {"TRAINER", "holds one pose"});
        expect_input_error([&] { motion::compare(trainer(), still); }, {"TRAINEE", "holds one pose"});
        expect_input_error([&] { motion::compare(still, still); }, {"holds one pose"});
    }
    // A body that only slides about does not move either.
    for (size_t f = 0; f < held.frames.size(); ++f)
        for (motion::JointSample& sample : held.frames[f]) sample.position.x += 0.1 * static_cast<double>(f);
    expect_input_error([&] { motion::compare(held, held); }, {"holds one pose"});
}

TEST(Compare, NeedsAnArmOrALegThatBothKnow) {
    using enum motion::Joint;
    motion::SkeletonClip right = trainer(), left = trainer();
    hide(right, {kLeftElbow, kLeftWrist, kLeftKnee, kLeftAnkle, kLeftBigToe});
    hide(left, {kRightElbow, kRightWrist, kRightKnee, kRightAnkle, kRightBigToe});
    expect_input_error([&] { motion::compare(right, left); }, {"no arm and no leg"});
    EXPECT_DOUBLE_EQ(motion::compare(right, right).score, 100);
    motion::CompareOptions trunk_alone;
    trunk_alone.counted = {true, true, false, false, false, false};
    EXPECT_DOUBLE_EQ(motion::compare(right, left, trunk_alone).score, 100);
    // A limb that is seen for a moment alone has no score.
    motion::SkeletonClip briefly = trainer();
    hide(briefly, {kLeftElbow, kLeftWrist}, 4);
    EXPECT_EQ(motion::compare(trainer(), briefly).limb_scores[motion::index_of(Limb::kLeftArm)], -1);
}

// Left and right exchanged look like somebody who stands turned about, until the knees bend.
TEST(Compare, RefusesExchangedSides) {
    motion::SkeletonClip exchanged = trainer();
    for (motion::Pose& pose : exchanged.frames) {
        pose = motion::mirrored(pose);
        for (motion::JointSample& sample : pose) sample.position.x = -sample.position.x;
    }
    EXPECT_FALSE(motion::faces_backwards(trainer()));
    EXPECT_TRUE(motion::faces_backwards(exchanged));
    expect_input_error([&] { motion::compare(trainer(), exchanged); }, {"TRAINEE", "left and right exchanged"});
    expect_input_error([&] { motion::compare(exchanged, trainer()); }, {"TRAINER", "left and right exchanged"});
    for (const motion::SkeletonClip& clip : trainers()) EXPECT_FALSE(motion::faces_backwards(another(clip)));
    // Nor is somebody turned about who bends forwards until the head hangs.
    motion::SkeletonClip bent = trainer();
    for (motion::Pose& pose : bent.frames) {
        const glm::dvec3 pelvis = motion::at(pose, motion::Joint::kPelvis).position;
        const glm::dvec3 hips =
            motion::at(pose, motion::Joint::kLeftHip).position - motion::at(pose, motion::Joint::kRightHip).position;
        const glm::dquat bend = glm::angleAxis(glm::radians(130.0), glm::normalize(hips));
        for (size_t j = motion::index_of(motion::Joint::kNeck); j < motion::index_of(motion::Joint::kRightHip); ++j)
            pose[j].position = pelvis + bend * (pose[j].position - pelvis);
    }
    EXPECT_FALSE(motion::faces_backwards(bent));
}

TEST(Compare, ErrorsAreThoseOfTheFormulas) {
    const auto other = test::with_noise(test::at_speed(trainer(), 0.8), 0.05, 3);
    motion::SkeletonClip clip = trainer();
    for (size_t f = 0; f < 75; f += 3) motion::at(clip.frames[f], motion::Joint::kRightElbow).confidence = 0.4;
    for (size_t f = 0; f < 75; f += 5) motion::at(clip.frames[f], motion::Joint::kLeftAnkle).measured = false;
    for (size_t f = 0; f < 75; ++f) {
        const motion::LimbErrors errors =
            motion::limb_errors(motion::directions_of(clip.frames[f]), motion::directions_of(other.frames[f]));
        for (size_t limb = 0; limb < motion::kLimbs; ++limb)
            EXPECT_NEAR(errors[limb], reference::limb_error(clip.frames[f], other.frames[f], static_cast<Limb>(limb)),
                        1e-6)
                << f << ' ' << limb;
    }
}

// The path is one of least cost, by the table of all paths.
TEST(Compare, WarpsAtLeastCost) {
    const motion::Motion shown = motion::motion_of(trainer());
    for (const double speed : {0.7, 1.0, 1.3}) {
        const motion::Motion done = motion::motion_of(another(test::at_speed(trainer(), speed)));
        std::vector<std::vector<double>> distances;
        for (const motion::Directions& frame : done.frames) {
            distances.emplace_back();
            for (const motion::Directions& other : shown.frames)
                distances.back().push_back(motion::distance(other, frame, true));
        }
        const motion::Warp found = motion::warp(shown, done, 100, true);
        EXPECT_NEAR(found.cost, reference::least_cost(distances, motion::kWarpStepCost), 1e-9);
        EXPECT_TRUE(std::ranges::is_sorted(found.frames));
        // A band that the best path keeps to changes nothing.
        EXPECT_NEAR(motion::warp(shown, done, 0.8, true).cost, found.cost, 1e-9);
        for (size_t i = 0; i < found.frames.size(); ++i)
            EXPECT_NEAR(found.frames[i], std::min(74.0, speed * static_cast<double>(i)), 5) << speed;
    }
}

TEST(Compare, WarpsMotionsOfVeryDifferentLengths) {
    motion::Motion shown = motion::motion_of(trainer()), done = shown;
    done.frames.resize(2);
    EXPECT_EQ(motion::warp(shown, done, 0.1, true).frames.size(), 2u);
    EXPECT_EQ(motion::warp(done, shown, 0.1, true).frames.size(), 75u);
    done.frames.resize(1);
    EXPECT_EQ(motion::warp(shown, done, 0.1, true).frames.size(), 1u);
    motion::SkeletonClip slow = trainer();
    slow.fps = 1e-3;
    motion::SkeletonClip fast = trainer();
    fast.fps = 1e4;
    expect_input_error([&] { motion::compare(fast, slow); }, {"too long"});
}

TEST(OnlineWarp, FollowsATraineeWhoLags) {
    const motion::Motion shown = motion::motion_of(trainer());
    const motion::Motion done = motion::motion_of(another(test::at_speed(trainer(), 0.85)));
    motion::OnlineWarp warp(shown, 1);
    for (size_t f = 0; f < 75; ++f) {
        const double matched = warp.add(done.frames[f], static_cast<double>(f) / 25);
        if (f <= 12) continue;  // until it has found the lag
        EXPECT_NEAR(matched, 0.85 * static_cast<double>(f) / 25, 0.12) << f;
    }
}

TEST(OnlineWarp, FindsItsWayAfterAJump) {
    const motion::Motion shown = motion::motion_of(trainer());
    motion::OnlineWarp warp(shown, 0.2);
    warp.add(shown.frames[2], 2 / 25.0);
    EXPECT_NEAR(warp.add(shown.frames[60], 60 / 25.0), 60 / 25.0, 1e-9);
    EXPECT_NEAR(warp.add(shown.frames[61], 61 / 25.0), 61 / 25.0, 1e-9);
}

TEST(SkeletonClip, APoseAtAFrameIsThatFrames) {
    motion::SkeletonClip clip = trainer();
    motion::at(clip.frames[5], motion::Joint::kNose) = {};
    motion::at(clip.frames[7], motion::Joint::kNose).measured = false;
    EXPECT_EQ(motion::at(motion::pose_at(clip, 5), motion::Joint::kNose).confidence, 0);
    EXPECT_TRUE(motion::at(motion::pose_at(clip, 6), motion::Joint::kNose).measured);
    EXPECT_FALSE(motion::at(motion::pose_at(clip, 6.5), motion::Joint::kNose).measured);
    EXPECT_EQ(motion::at(motion::pose_at(clip, 99), motion::Joint::kNeck).position,
              motion::at(clip.frames[74], motion::Joint::kNeck).position);
}

TEST(BestView, IsAcrossTheErrors) {
    const std::vector<motion::WeightedError> errors = {{{0.3, 0, 0}, 1}, {{0, 0.2, 0}, 2}, {{0.1, 0.1, 0}, 1}};
    const glm::dvec3 view = motion::best_view_direction(errors);
    EXPECT_NEAR(std::abs(view.z), 1, 1e-9);
    double most = 0;
    for (int i = 0; i < 400; ++i) {
        const double up = std::acos(1 - (2.0 * i + 1) / 400), turn = 2.399963 * i;
        most = std::max(most, motion::visible_error(errors, {std::sin(up) * std::cos(turn), std::cos(up),
                                                             std::sin(up) * std::sin(turn)}));
    }
    EXPECT_GE(motion::visible_error(errors, view), most);
    // Errors on one line are seen from all directions across it: a level one is chosen.
    const std::vector<motion::WeightedError> line = {{{0.2, 0.3, 0}, 1}};
    const glm::dvec3 level = motion::best_view_direction(line);
    EXPECT_NEAR(level.y, 0, 1e-9);
    EXPECT_NEAR(glm::dot(level, line[0].error), 0, 1e-9);
    test::expect_near(motion::best_view_direction({}), {0, 0, 1});
    // Level errors show best from above; of level views, from across them.
    const std::vector<motion::WeightedError> flat = {{{0.3, 0, 0.3}, 1}, {{0.1, 0.05, 0.12}, 1}};
    const glm::dvec3 side = motion::best_level_view(flat);
    EXPECT_EQ(side.y, 0);
    for (int i = 0; i < 180; ++i) {
        const double turn = i * std::numbers::pi / 180;
        EXPECT_LE(motion::visible_error(flat, {std::cos(turn), 0, std::sin(turn)}),
                  motion::visible_error(flat, side) + 1e-9);
    }
}

}  // namespace
}  // namespace neuvv

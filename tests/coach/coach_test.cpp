// The coach while a trainee performs: what is red, how fast the clip plays, what is recorded.
#include "coach/coach.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coach/guide.h"
#include "motion/detector.h"
#include "motion/trainee.h"

namespace neuvv::test::coach_test {
namespace {

using motion::Limb;

constexpr double kRate = 50;

const motion::SkeletonClip& dancer() {
    static const motion::SkeletonClip clip = performer_motion(75);
    return clip;
}

motion::SkeletonClip elsewhere(const motion::SkeletonClip& clip) {
    return other_body(clip, 0.85, {3, 0, -1}, 2.1);
}

motion::TimedPose pose_of(const motion::SkeletonClip& clip, double time_s) {
    return {time_s, motion::pose_at(clip, time_s * clip.fps)};
}

double& red(std::array<double, motion::kLimbs>& of, Limb limb) {
    return of[motion::index_of(limb)];
}

// Plays the clip from the beginning; calls `each` after each update.
template <typename Each>
void perform(coach::Coach& coach, const motion::SkeletonClip& trainee, double seconds, const Each& each) {
    for (double t = 0; t <= seconds; t += 1 / kRate) {
        coach.update(pose_of(trainee, t), t, t);
        each(t);
    }
}

TEST(Coach, ReddensTheLimbThatIsOffAndPointsToWhereItShouldBe) {
    coach::Coach coach(dancer(), {});
    const auto trainee = elsewhere(with_arm_off(dancer(), Limb::kRightArm, 30, 1, 2));
    double most = 0;
    size_t arrows = 0;
    perform(coach, trainee, 2.9, [&](double t) {
        coach::LimbValues values = coach.red();
        most = std::max(most, red(values, Limb::kRightArm));
        red(values, Limb::kRightArm) = 0;
        EXPECT_EQ(values, coach::LimbValues{}) << t;
        for (const coach::JointError& error : coach.errors()) {
            EXPECT_EQ(motion::info_of(error.joint).limb, Limb::kRightArm);
            ++arrows;
        }
    });
    EXPECT_EQ(most, 1);
    EXPECT_GT(arrows, 20u);
    ASSERT_TRUE(coach.last_mistake_s());
    EXPECT_NEAR(*coach.last_mistake_s(), 0.4, 0.25) << "a second before the arm turned red at about 1.4 s";
    EXPECT_TRUE(coach.best_eye());
}

// A clock that changes its speed divides its frames anew.
TEST(Coach, APartOfAFrameThatIsShownAgainIsNoJump) {
    coach::CoachSettings settings;
    settings.mode = coach::Mode::kPerform;
    coach::Coach coach(dancer(), settings);
    const motion::SkeletonClip trainee = elsewhere(dancer());
    int image = 0;
    for (double t = 0.04; t <= 2; t += 1 / kRate, ++image)
        coach.update(pose_of(trainee, t), t, image % 2 ? t - 0.9 / dancer().fps : t);
    ASSERT_GT(coach.recorded().frames.size(), 45u);
    const auto wrist = [](const motion::Pose& pose) { return motion::at(pose, motion::Joint::kLeftWrist).position; };
    EXPECT_LT(glm::distance(wrist(coach.recorded().frames[10]), wrist(trainee.frames[10])), 0.05)
        << "the record was not begun anew";
    EXPECT_GT(glm::distance(wrist(coach.recorded().frames[10]), wrist(trainee.frames[45])), 0.1);
}

TEST(Coach, TheGhostOfACorrectPerformanceLiesInTheTrainer) {
    coach::Coach coach(dancer(), {});
    perform(coach, elsewhere(dancer()), 2.9, [&](double t) {
        if (t < 0.5) return;  // until the direction is known
        const motion::Pose ghost = coach.ghost().value();
        for (size_t j = 0; j < motion::kJoints; ++j)
            EXPECT_LT(glm::distance(ghost[j].position, coach.shown()[j].position), 0.12) << t;
        EXPECT_EQ(coach::guide_of(coach).size(), motion::kJoints - 1) << "bones and no arrow";
    });
}

TEST(Coach, TheClipWaitsForATraineeWhoIsLateAndNotOtherwise) {
    coach::Coach coach(dancer(), {});
    perform(coach, elsewhere(dancer()), 2.5, [&](double) { EXPECT_GT(coach.clip_speed(), 0.75); });
    coach::Coach slower(dancer(), {});
    double slowest = 1;
    perform(slower, elsewhere(with_arm_off(dancer(), Limb::kLeftArm, 40, 1, 2)), 2.5,
            [&](double) { slowest = std::min(slowest, slower.clip_speed()); });
    EXPECT_NEAR(slowest, 0.2, 1e-9);
    coach::CoachSettings strict;
    strict.mode = coach::Mode::kPerform;
    strict.speed = 0.5;
    coach::Coach perform_on(dancer(), strict);
    perform(perform_on, elsewhere(with_arm_off(dancer(), Limb::kLeftArm, 40, 1, 2)), 2.5,
            [&](double) { EXPECT_EQ(perform_on.clip_speed(), 0.5); });
}

TEST(Coach, WhoIsGoneIsNotComparedAndTheClipGoesOn) {
    coach::Coach coach(dancer(), {});
    EXPECT_FALSE(coach.ghost());
    EXPECT_EQ(coach.highlight(), nullptr);
    const auto trainee = elsewhere(with_arm_off(dancer(), Limb::kLeftArm, 40, 0, 3));
    perform(coach, trainee, 1.5, [](double) {});
    EXPECT_GT(std::ranges::max(coach.red()), 0.9);
    coach.update(std::nullopt, 2.4, 1.6);
    EXPECT_GT(std::ranges::max(coach.red()), 0.9) << "a gap of less than a second";
    coach.update(std::nullopt, 2.6, 1.7);
    EXPECT_EQ(coach.red(), coach::LimbValues{});
    EXPECT_EQ(coach.clip_speed(), 1);
    EXPECT_FALSE(coach.ghost());
    EXPECT_TRUE(coach.remarks().empty());
    EXPECT_TRUE(coach::guide_of(coach).empty());
}

TEST(Coach, WatchingComparesNothing) {
    coach::CoachSettings settings;
    settings.mode = coach::Mode::kWatch;
    coach::Coach coach(dancer(), settings);
    perform(coach, elsewhere(with_arm_off(dancer(), Limb::kLeftArm, 40, 0, 3)), 2, [&](double) {
        EXPECT_EQ(coach.highlight(), nullptr);
        EXPECT_EQ(coach.red(), coach::LimbValues{});
    });
    EXPECT_TRUE(coach.recorded().frames.empty());
}

TEST(Coach, AMirrorImageOfTheMotionIsRightWhereAMirrorIsAskedFor) {
    motion::SkeletonClip mirror = elsewhere(dancer());
    for (motion::Pose& pose : mirror.frames) pose = motion::mirrored(pose);
    coach::CoachSettings settings;
    settings.mode = coach::Mode::kPerform;
    const auto score = [&](bool mirrored) {
        settings.mirrored = mirrored;
        coach::Coach coach(dancer(), settings);
        perform(coach, mirror, 2.9, [](double) {});
        return coach.feedback().score;
    };
    EXPECT_GE(score(true), 95);
    EXPECT_LT(score(false), 80);
}

TEST(Coach, LimbsThatAreLeftOutAreNotRed) {
    coach::Coach coach(dancer(), {});
    const auto trainee = elsewhere(with_arm_off(dancer(), Limb::kLeftArm, 40, 0, 3));
    coach::CoachSettings settings;
    settings.compare.counted[motion::index_of(Limb::kLeftArm)] = false;
    coach.change(settings);
    perform(coach, trainee, 2.5, [&](double) { EXPECT_EQ(coach.red(), coach::LimbValues{}); });
}

TEST(Coach, APerformanceIsRecordedAsLongAsTheClipAndNoLonger) {
    coach::CoachSettings settings;
    settings.mode = coach::Mode::kPerform;
    coach::Coach coach(dancer(), settings);
    const motion::SkeletonClip trainee = elsewhere(with_arm_off(dancer(), Limb::kLeftArm, 30, 1, 2));
    // Ten rounds of the clip.
    const double length_s = static_cast<double>(dancer().frames.size() - 1) / dancer().fps;
    for (int i = 0; i < 1500; ++i) {
        const double t = i / kRate, clip_s = std::fmod(t, length_s);
        motion::TimedPose pose = pose_of(trainee, clip_s);
        pose.time_s = t;
        coach.update(pose, t, clip_s);
        EXPECT_LE(coach.recorded().frames.size(), dancer().frames.size());
    }
    EXPECT_GE(coach.recorded().frames.size() + 1, dancer().frames.size()) << "the last whole one is kept";
    perform(coach, trainee, 0, [](double) {});
    for (double t = 40; t < 40 + length_s; t += 1 / kRate) {
        motion::TimedPose pose = pose_of(trainee, t - 40);
        pose.time_s = t;
        coach.update(pose, t, t - 40);
    }
    const motion::Comparison found = motion::compare(dancer(), coach.recorded());
    ASSERT_EQ(found.mistakes.size(), 1u);
    EXPECT_EQ(found.mistakes[0].limb, Limb::kLeftArm);
}

TEST(Coach, WhatNobodyPerformedIsNoPerformance) {
    coach::CoachSettings settings;
    settings.mode = coach::Mode::kPerform;
    coach::Coach coach(dancer(), settings);
    const motion::SkeletonClip trainee = elsewhere(dancer());
    double now_s = 0;
    const auto play = [&](double from_s, double to_s) {
        for (double t = from_s; t <= to_s; t += 1 / kRate, now_s += 1 / kRate) {
            motion::TimedPose pose = pose_of(trainee, t);
            pose.time_s = now_s;
            coach.update(pose, now_s, t);
        }
    };
    const auto wrist = [](const motion::Pose& pose) { return motion::at(pose, motion::Joint::kLeftWrist); };
    play(0, 2.95);
    play(1.8, 2.95);  // back to a mistake, and on from there
    play(0, 0.2);
    ASSERT_GT(coach.recorded().frames.size(), 70u);
    EXPECT_LT(glm::distance(wrist(coach.recorded().frames[25]).position, wrist(trainee.frames[25]).position), 0.05)
        << "the whole performance is kept";
    coach::Coach late(dancer(), settings);
    late.update(pose_of(trainee, 2), 2, 2);
    ASSERT_GT(late.recorded().frames.size(), 50u);
    EXPECT_EQ(wrist(late.recorded().frames[10]).confidence, 0) << "nobody was there";
    EXPECT_EQ(late.shown_to_recorded().frames.size(), late.recorded().frames.size());
}

TEST(Coach, AgainLeadsBackToTheSameMistake) {
    coach::Coach coach(dancer(), {});
    const auto trainee = elsewhere(with_arm_off(dancer(), Limb::kLeftArm, 40, 1, 3));
    perform(coach, trainee, 2, [](double) {});
    ASSERT_TRUE(coach.last_mistake_s());
    const double first = *coach.last_mistake_s();
    motion::TimedPose pose = pose_of(trainee, first);
    pose.time_s = 2.5;
    coach.update(pose, 2.5, first);  // again
    pose.time_s = 2.52;
    coach.update(pose, 2.52, first + 0.04);
    EXPECT_EQ(*coach.last_mistake_s(), first);
}

TEST(Coach, ThreePointsAloneAreAGhostOfTwoHands) {
    coach::Coach coach(dancer(), {});
    motion::SkeletonClip points = elsewhere(dancer());
    for (motion::Pose& pose : points.frames)
        for (size_t j = 0; j < motion::kJoints; ++j) {
            using enum motion::Joint;
            const motion::Joint joint = motion::joint_at(j);
            if (joint != kNose && joint != kLeftWrist && joint != kRightWrist) pose[j] = {};
        }
    perform(coach, points, 1, [&](double) {
        ASSERT_TRUE(coach.ghost());
        EXPECT_EQ(coach.red(), coach::LimbValues{});
    });
    EXPECT_EQ(coach.feedback().score, -1) << "no direction is known";
}

}  // namespace
}  // namespace neuvv::test::coach_test

// Feedback while somebody performs: poses arrive 60 times a second, with a centimetre of noise.
#include "motion/live/live.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/trainee.h"

namespace neuvv {
namespace {

using motion::Limb;

constexpr double kRate = 60;

const motion::SkeletonClip& dancer() {
    static const motion::SkeletonClip clip = test::performer_motion(75);
    return clip;
}

motion::SkeletonClip elsewhere(const motion::SkeletonClip& clip) {
    return test::other_body(clip, 0.85, {3, 0, -1}, 2.1);
}

struct Sample {
    double time_s = 0;
    motion::Feedback feedback;
};

// What is said while the trainee performs and the clip plays at its own rate.
std::vector<Sample> perform(const motion::SkeletonClip& trainee) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, 0.01);
    motion::LiveComparison live(dancer(), {});
    std::vector<Sample> samples;
    const double end_s = static_cast<double>(dancer().frames.size() - 1) / dancer().fps;
    for (double t = 0; t <= end_s; t += 1 / kRate) {
        motion::Pose pose = motion::pose_at(trainee, t * trainee.fps);
        for (motion::JointSample& sample : pose)
            sample.position += glm::dvec3(normal(random), normal(random), normal(random));
        samples.push_back({t, live.add(pose, t, t)});
    }
    return samples;
}

// Expects that the limb is wrong within a span, a moment after its beginning, and that nothing else ever is.
void expect_wrong(const std::vector<Sample>& samples, Limb limb, double first_s, double last_s) {
    constexpr double kSettle_s = 0.55;  // the filter, 0.3 s until a limb turns red, and noise
    for (const Sample& sample : samples)
        for (size_t i = 0; i < motion::kLimbs; ++i) {
            const motion::LimbFeedback& said = sample.feedback.limbs[i];
            const bool own = i == motion::index_of(limb);
            const bool before = sample.time_s<first_s, after = sample.time_s> last_s + kSettle_s;
            if (!own || before || after) {
                EXPECT_FALSE(said.wrong) << motion::kLimbNames[i] << ' ' << sample.time_s;
            } else if (sample.time_s > first_s + kSettle_s && sample.time_s < last_s) {
                EXPECT_TRUE(said.wrong) << sample.time_s << " error " << said.error_deg;
            }
        }
}

TEST(Live, ACorrectPerformanceIsNeverRed) {
    for (const double speed : {1.0, 0.9}) {
        const std::vector<Sample> samples = perform(elsewhere(test::at_speed(dancer(), speed)));
        for (const Sample& sample : samples)
            for (const motion::LimbFeedback& limb : sample.feedback.limbs) {
                EXPECT_FALSE(limb.wrong) << sample.time_s;
                EXPECT_EQ(limb.red, 0);
            }
        std::printf("live, %.0f %% speed: score %.1f\n", 100 * speed, samples.back().feedback.score);
        EXPECT_GE(samples.back().feedback.score, 95);
        EXPECT_NEAR(std::remainder(samples.back().feedback.yaw - 2.1, 2 * std::numbers::pi), 0, 0.05);
    }
}

TEST(Live, TwoPosesHaveNoScore) {
    motion::LiveComparison live(dancer(), {});
    const auto pose = [](double t) { return motion::pose_at(dancer(), t * dancer().fps); };
    live.add(pose(0), 0, 0);
    EXPECT_EQ(live.feedback().score, -1);
    EXPECT_GE(live.feedback().limbs[0].error_deg, 0) << "limbs are judged";
    live.add(pose(2), 2, 2);
    EXPECT_EQ(live.feedback().score, -1);
    for (double t = 2; t < 2.9; t += 1 / kRate) live.add(pose(t), t, t);
    EXPECT_GT(live.feedback().score, 90);
    // Of a short clip half is enough.
    motion::SkeletonClip brief = dancer();
    brief.frames.resize(8);
    motion::LiveComparison short_live(brief, {});
    for (double t = 0; t < 0.28; t += 0.04) short_live.add(pose(t), t, t);
    EXPECT_GT(short_live.feedback().score, 90);
}

// A slow camera or a busy machine: every third frame of the clip is seen.
TEST(Live, FewImagesAreEnough) {
    const auto judged = [](const motion::SkeletonClip& trainee) {
        motion::LiveComparison live(dancer(), {});
        std::array<double, motion::kLimbs> red_s{};
        for (double t = 0; t < 2.9; t += 0.12) {
            const motion::Feedback& said = live.add(motion::pose_at(trainee, t * trainee.fps), t, t);
            for (size_t i = 0; i < motion::kLimbs; ++i) red_s[i] += said.limbs[i].wrong ? 0.12 : 0;
        }
        return std::pair(red_s, live.feedback().score);
    };
    const auto [never, score] = judged(elsewhere(dancer()));
    for (const double each : never) EXPECT_EQ(each, 0);
    EXPECT_GE(score, 95);
    const auto [red_s, less] = judged(elsewhere(test::with_arm_off(dancer(), Limb::kLeftArm, 30, 1, 2)));
    for (size_t i = 0; i < motion::kLimbs; ++i)
        if (i == motion::index_of(Limb::kLeftArm))
            EXPECT_GT(red_s[i], 0.4);
        else
            EXPECT_EQ(red_s[i], 0) << motion::kLimbNames[i];
}

TEST(Live, AnArmThatIsOffTurnsRedAndBack) {
    const auto samples = perform(elsewhere(test::with_arm_off(dancer(), Limb::kRightArm, 25, 1, 2)));
    expect_wrong(samples, Limb::kRightArm, 1, 2);
    EXPECT_EQ(samples.back().feedback.limbs[motion::index_of(Limb::kRightArm)].red, 0);
}

TEST(Live, ALateLegIsSaidToBeLate) {
    const auto samples = perform(elsewhere(test::with_late_leg(dancer(), Limb::kLeftLeg, 0.4, 0, 3)));
    double seconds = 0, late = 0;
    for (const Sample& sample : samples)
        for (size_t i = 0; i < motion::kLimbs; ++i) {
            const motion::LimbFeedback& said = sample.feedback.limbs[i];
            if (i != motion::index_of(Limb::kLeftLeg)) {
                EXPECT_FALSE(said.wrong) << motion::kLimbNames[i];
            }
            if (!said.wrong || said.late_s == 0) continue;
            seconds += 1 / kRate;
            late += said.late_s / kRate;
        }
    EXPECT_GT(seconds, 0.5) << "for how long it was said";
    EXPECT_NEAR(late / seconds, 0.4, 0.08);
}

// The recorded trainee of tools/performer: the arm and the leg that do wrong turn red, and nothing else does.
TEST(Live, TheRecordedTraineesMistakesAreShown) {
    const auto samples = perform(motion::read_skeleton(NEUVV_SOURCE_DIR "/tools/performer/trainee.glb"));
    std::array<double, motion::kLimbs> red_s{};
    for (const Sample& sample : samples)
        for (size_t i = 0; i < motion::kLimbs; ++i) red_s[i] += sample.feedback.limbs[i].wrong ? 1 / kRate : 0;
    for (size_t i = 0; i < motion::kLimbs; ++i) {
        const bool planted = i == motion::index_of(Limb::kLeftArm) || i == motion::index_of(Limb::kRightLeg);
        EXPECT_EQ(red_s[i] > 0.3, planted) << motion::kLimbNames[i] << ' ' << red_s[i];
        EXPECT_TRUE(planted || red_s[i] == 0) << motion::kLimbNames[i] << ' ' << red_s[i];
    }
}

TEST(Live, AMirroredTurnIsTheTrunksAlone) {
    const auto trainee = test::with_mirrored_turn(dancer(), test::facing_of(dancer()), 1.7, 2.9);
    expect_wrong(perform(elsewhere(trainee)), Limb::kTrunk, 1.7, 2.9);
}

TEST(Live, LeavesOutPosesThatComeTooLate) {
    motion::LiveComparison live(dancer(), {});
    const auto pose = [](double t) { return motion::pose_at(dancer(), t * dancer().fps); };
    for (double t = 0; t < 1; t += 1 / kRate) live.add(pose(t), t, t);
    const motion::Feedback before = live.feedback();
    live.add(pose(2.5), 0.5, 0.5);  // was seen half a second ago
    EXPECT_EQ(live.feedback().score, before.score);
    EXPECT_EQ(live.feedback().trainer_time_s, before.trainer_time_s);
    // The clip jumps, and the trainee with it.
    live.jump();
    for (double t = 1; t < 2; t += 1 / kRate) live.add(pose(t - 1), t, t - 1);
    EXPECT_NEAR(live.feedback().trainer_time_s, 0.98, 0.1);
    EXPECT_GT(live.feedback().score, 99);
}

TEST(PoseFilter, SteadiesWhatRestsAndFollowsWhatMoves) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, 0.01);
    const auto run = [&](double speed) {
        motion::PoseFilter filter;
        double square = 0, behind = 0;
        size_t count = 0;
        for (int i = 0; i < 600; ++i) {
            const double t = i / kRate, x = speed * t;
            motion::Pose pose;
            motion::at(pose, motion::Joint::kNose) = {{x + normal(random), 1, 0}, 1, true};
            const double off = motion::at(filter.filter(pose, t), motion::Joint::kNose).position.x - x;
            if (i < 60) continue;
            square += off * off;
            behind -= off;
            ++count;
        }
        return std::pair{std::sqrt(square / double(count)), speed > 0 ? behind / double(count) / speed : 0};
    };
    EXPECT_LT(run(0).first, 0.005) << "half of the noise";
    EXPECT_LT(run(2).second, 0.025) << "seconds behind at 2 m/s";
    EXPECT_GT(run(2).second, 0);
    // A joint that was away begins anew where it comes back.
    motion::PoseFilter filter;
    motion::Pose pose;
    motion::at(pose, motion::Joint::kNose) = {{0, 1, 0}, 1, true};
    filter.filter(pose, 0);
    motion::at(pose, motion::Joint::kNose).position.x = 5;
    EXPECT_EQ(motion::at(filter.filter(pose, 1), motion::Joint::kNose).position.x, 5);
}

}  // namespace
}  // namespace neuvv

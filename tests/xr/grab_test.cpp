#include "xr/grab.h"

#include <gtest/gtest.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/xr/random_poses.h"

namespace neuvv {
namespace {

using test::kInfinite;
using test::kNan;
using test::max_difference;
using test::RandomPoses;

const xr::GrabSettings kFree = {.upright = false, .min_scale = 1e-6, .max_scale = 1e6};
const xr::GrabSettings kUpright = {.upright = true, .min_scale = 1e-6, .max_scale = 1e6};

glm::dmat4 random_node(RandomPoses& random) {
    return xr::matrix_of(random.pose()) * glm::scale(glm::dmat4(1), glm::dvec3(0.7, 1.5, -1));
}

// The world position of a point that was at `then` and belongs to a node, after the node's matrix has changed.
glm::dvec3 carried(const glm::dmat4& before, const glm::dmat4& after, glm::dvec3 then) {
    return after * glm::inverse(before) * glm::dvec4(then, 1);
}

glm::dvec3 grabbed_point(const xr::Pose& hand, double distance_m) {
    return xr::matrix_of(hand) * glm::dvec4(0, 0, -distance_m, 1);
}

// The scale of the similarity from one matrix to another.
double scale_between(const glm::dmat4& before, const glm::dmat4& after) {
    return std::cbrt(glm::determinant(glm::dmat3(after)) / glm::determinant(glm::dmat3(before)));
}

// Moves a hand, and gives the scale the time to follow.
void move_and_wait(xr::Grab& grab, int hand, const xr::Pose& pose) {
    grab.move(hand, pose);
    grab.advance(1000);
}

TEST(Grab, OneFreeHandHoldsItRigidly) {
    RandomPoses random(10);
    for (int i = 0; i < 100; ++i) {
        const glm::dmat4 node = random_node(random);
        const xr::Pose then = random.pose(), now = random.pose();
        xr::Grab grab(node, kFree);
        EXPECT_TRUE(grab.empty());
        grab.attach(1, then, random.number(0, 3));
        EXPECT_TRUE(grab.is_attached(1) && !grab.is_attached(0) && !grab.empty());
        EXPECT_LT(max_difference(grab.world_from_node(), node), 1e-12);
        grab.move(1, now);
        EXPECT_LT(max_difference(grab.world_from_node(), xr::matrix_of(now) * glm::inverse(xr::matrix_of(then)) * node),
                  1e-10);
    }
}

TEST(Grab, OneHandCarriesAnUprightThingOnItsRay) {
    RandomPoses random(11);
    for (int i = 0; i < 100; ++i) {
        const glm::dmat4 node = random_node(random);
        const double distance_m = random.number(0, 3);
        const xr::Pose then = random.pose(), now = random.near(then, 1, 1.5);
        xr::Grab grab(node, kUpright);
        grab.attach(0, then, distance_m);
        grab.move(0, now);
        const glm::dmat4 moved = grab.world_from_node();
        const glm::dvec3 at = carried(node, moved, grabbed_point(then, distance_m));
        EXPECT_LT(glm::distance(at, grabbed_point(now, distance_m)), 1e-10);
        const glm::dmat3 turn = glm::dmat3(moved * glm::inverse(node));
        EXPECT_LT(glm::distance(turn[1], glm::dvec3(0, 1, 0)), 1e-10) << "up stays up";
        EXPECT_NEAR(glm::determinant(turn), 1, 1e-10);
    }
}

TEST(Grab, OnlyYawTurnsAnUprightThing) {
    const xr::Pose then = {{0, 1, 0}, xr::turn_by(0.4) * glm::angleAxis(-0.6, glm::dvec3(1, 0, 0))};
    xr::Grab grab(glm::dmat4(1), kUpright);
    grab.attach(0, then, 0);
    grab.move(0, {then.position, xr::turn_by(1.1) * glm::angleAxis(0.5, glm::dvec3(1, 0, 0))});
    const glm::dvec3 x = grab.world_from_node()[0];
    EXPECT_NEAR(std::atan2(-x.z, x.x), 0.7, 1e-12);
}

TEST(Grab, TwoFreeHandsKeepWhatTheyHold) {
    RandomPoses random(12);
    for (int i = 0; i < 100; ++i) {
        const glm::dmat4 node = random_node(random);
        const std::array<xr::Pose, 2> then = {random.pose(), random.pose()}, now = {random.pose(), random.pose()};
        xr::Grab grab(node, kFree);
        for (const int hand : {0, 1}) {
            grab.attach(hand, then[static_cast<size_t>(hand)]);
            EXPECT_LT(max_difference(grab.world_from_node(), node), 1e-12);
        }
        for (const int hand : {0, 1}) move_and_wait(grab, hand, now[static_cast<size_t>(hand)]);
        const glm::dmat4 moved = grab.world_from_node();
        for (size_t hand : {0U, 1U})
            EXPECT_LT(glm::distance(carried(node, moved, then[hand].position), now[hand].position), 1e-9) << i;
        const double ratio =
            glm::distance(now[0].position, now[1].position) / glm::distance(then[0].position, then[1].position);
        EXPECT_NEAR(scale_between(node, moved), ratio, 1e-9 * ratio);
        EXPECT_NEAR(grab.scale(), ratio, 1e-9 * ratio);
        const glm::dmat3 turn = glm::dmat3(moved * glm::inverse(node)) / ratio;
        EXPECT_LT(glm::distance(turn * glm::transpose(turn) * glm::dvec3(1, 2, 3), {1, 2, 3}), 1e-9) << "a similarity";
    }
}

// Two hands that point at something 4 m away.
struct FarGrab {
    std::array<xr::Pose, 2> hands{{{{-0.2, 1, 0}}, {{0.2, 1, 0}}}};
    xr::Grab grab;
    explicit FarGrab(const xr::GrabSettings& settings) : grab(glm::dmat4(1), settings) {
        for (const int hand : {0, 1}) grab.attach(hand, hands[static_cast<size_t>(hand)], 4);
    }
};

TEST(Grab, AWristThatTurnsScalesAndTurnsNothing) {
    for (const xr::GrabSettings& settings : {kFree, kUpright})
        for (const double degrees : {1.0, -1.0, 10.0}) {
            FarGrab far(settings);
            move_and_wait(far.grab, 1, {far.hands[1].position, xr::turn_by(glm::radians(degrees))});
            EXPECT_NEAR(far.grab.scale(), 1, 1e-12) << degrees;
            EXPECT_LT(max_difference(glm::dmat3(far.grab.world_from_node()), glm::dmat3(1)), 1e-12);
        }
}

TEST(Grab, FarAwayTheHandsScaleAsTheyDoNearby) {
    for (const xr::GrabSettings& settings : {kFree, kUpright}) {
        FarGrab far(settings);
        move_and_wait(far.grab, 1, {{0.6, 1, 0}});
        EXPECT_NEAR(far.grab.scale(), 2, 1e-9);
        move_and_wait(far.grab, 1, {{-0.2, 1, -0.8}});  // a quarter to the left
        const glm::dvec3 x = glm::normalize(glm::dvec3(far.grab.world_from_node()[0]));
        EXPECT_LT(glm::distance(x, {0, 0, -1}), 1e-9);
        EXPECT_NEAR(far.grab.scale(), 2, 1e-9);
    }
}

TEST(Grab, HandsThatTrembleDoNotScale) {
    constexpr double kFrame_s = 1.0 / 90, kTremble_m = 0.001;
    FarGrab far(kUpright);
    double most = 0, raw = 0;
    for (int i = 0; i < 900; ++i) {
        // 10 Hz, as hands tremble.
        const double off = kTremble_m * std::sin(i * kFrame_s * 10 * 2 * glm::pi<double>());
        far.grab.move(1, {{0.2 + off, 1, 0}});
        far.grab.advance(kFrame_s);
        most = std::max(most, std::abs(far.grab.scale() - 1));
        raw = std::max(raw, std::abs(off) / 0.4);
    }
    EXPECT_LT(most, 0.3 * raw);
    // A hand that means it is followed: half a metre in half a second.
    for (int i = 0; i < 45; ++i) {
        far.grab.move(1, {{0.2 + (i + 1) / 90.0, 1, 0}});
        far.grab.advance(kFrame_s);
        EXPECT_NEAR(far.grab.scale(), 1 + (i + 1) / 36.0, 0.01) << i;
    }
    for (int i = 0; i < 20; ++i) far.grab.advance(kFrame_s);
    EXPECT_NEAR(far.grab.scale(), 2.25, 0.01);
}

TEST(Grab, TwoHandsTurnAnUprightThingLikeTheirLineSeenFromAbove) {
    xr::Grab grab(glm::dmat4(1), kUpright);
    grab.attach(0, {{-0.2, 1, 0}});
    grab.attach(1, {{0.2, 1, 0}});
    // The line turns by a quarter to the left, and tilts up.
    move_and_wait(grab, 0, {{1, 1, 0.3}});
    move_and_wait(grab, 1, {{1, 1.4, -0.3}});
    const glm::dmat4 moved = grab.world_from_node();
    EXPECT_LT(glm::distance(glm::normalize(glm::dvec3(moved[0])), {0, 0, -1}), 1e-12);
    EXPECT_LT(glm::distance(glm::normalize(glm::dvec3(moved[1])), {0, 1, 0}), 1e-12);
    EXPECT_NEAR(glm::length(glm::dvec3(moved[1])), std::hypot(0.6, 0.4) / 0.4, 1e-12);
    EXPECT_LT(glm::distance(carried(glm::dmat4(1), moved, {0, 1, 0}), {1, 1.2, 0}), 1e-12) << "the centre";
}

TEST(Grab, AVerticalLineGivesNoYaw) {
    RandomPoses random(13);
    xr::Grab grab(glm::dmat4(1), kUpright);
    grab.attach(0, {{0, 0.5, 0}});
    grab.attach(1, {{0, 1.5, 0}});
    for (int i = 0; i < 50; ++i) {
        grab.move(1, {{random.number(-0.1, 0.1), 1.5, random.number(-0.1, 0.1)}});
        const glm::dmat4 moved = grab.world_from_node();
        EXPECT_LT(std::abs(moved[0].z) + std::abs(moved[2].x), 1e-12);
    }
    // When the line leaves the vertical, it turns the node from there: from +X to −Z is a quarter turn to the left.
    grab.move(1, {{1, 1.5, 0}});
    grab.move(1, {{0.7, 1.5, -0.7}});
    grab.move(1, {{0, 1.5, -1}});
    const glm::dvec3 x = grab.world_from_node()[0];
    EXPECT_NEAR(std::atan2(-x.z, x.x), glm::radians(90.0), 1e-9);

    xr::Grab at_once(glm::dmat4(1), kUpright);
    at_once.attach(0, {{0, 0.5, 0}});
    at_once.attach(1, {{0, 1.5, 0}});
    at_once.move(1, {{1, 1.5, 0}});
    EXPECT_LT(std::abs(at_once.world_from_node()[0].z), 1e-12) << "nothing to turn from";
}

TEST(Grab, AFullTurnOfTheLineIsOne) {
    for (const xr::GrabSettings& settings : {kFree, kUpright}) {
        xr::Grab grab(glm::dmat4(1), settings);
        grab.attach(0, {{-0.3, 1, 0}});
        grab.attach(1, {{0.3, 1, 0}});
        for (int degrees = 1; degrees <= 360; ++degrees) {
            const double angle = glm::radians(static_cast<double>(degrees));
            const glm::dvec3 out(0.3 * std::cos(angle), 1e-3 * std::cos(7 * angle), -0.3 * std::sin(angle));
            grab.move(0, {glm::dvec3(0, 1, 0) - out});
            grab.move(1, {glm::dvec3(0, 1, 0) + out});
            const glm::dvec3 x = grab.world_from_node()[0], y = grab.world_from_node()[1];
            EXPECT_LT(glm::distance(x, out / 0.3), 0.01) << degrees;
            EXPECT_LT(glm::distance(y, {0, 1, 0}), 0.05) << degrees << ": does not flip at half a turn";
        }
    }
}

TEST(Grab, HalfATurnInOneFrameIsFinite) {
    for (const glm::dvec3 out : {glm::dvec3(0.3, 0, 0), glm::dvec3(0, 0.3, 0), glm::dvec3(0.1, 0.2, -0.3)}) {
        xr::Grab grab(glm::dmat4(1), kFree);
        grab.attach(0, {-out, {1, 0, 0, 0}});
        grab.attach(1, {out, {1, 0, 0, 0}});
        move_and_wait(grab, 0, {out * 3.0, {1, 0, 0, 0}});
        EXPECT_LT(glm::distance(carried(glm::dmat4(1), grab.world_from_node(), -out), out * 3.0), 1e-9);
        EXPECT_LT(glm::distance(carried(glm::dmat4(1), grab.world_from_node(), out), out), 1e-9);
    }
}

// Random events: attaching, detaching, moving a little, pushing by nothing. The matrix changes only where a hand moves,
// and by little.
TEST(Grab, NeverJumps) {
    for (uint32_t seed = 0; seed < 20; ++seed) {
        RandomPoses random(100 + seed);
        const bool upright = seed % 2 == 0;
        xr::Grab grab(random_node(random), {.upright = upright, .min_scale = 0.2, .max_scale = 4});
        std::array<xr::Pose, 2> hands = {random.pose(0.5), random.pose(0.5)};
        for (int i = 0; i < 2000; ++i) {
            const int hand = random.number(0, 1) < 0.5 ? 0 : 1;
            xr::Pose& pose = hands[static_cast<size_t>(hand)];
            const glm::dmat4 before = grab.world_from_node();
            const double event = random.number(0, 1);
            double max = 1e-9;
            if (event < 0.05) {
                pose = random.pose(0.5);
                grab.attach(hand, pose, random.number(0, 1));
            } else if (event < 0.1) {
                grab.detach(hand);
            } else if (event < 0.15) {
                grab.push(hand, 0);
            } else {
                pose = random.near(pose, 1e-5, 1e-5);
                grab.move(hand, pose);
                // With points 2 cm apart, a move turns and scales the node by about 2e-3, which shows up to 10 m away.
                max = 0.1;
            }
            const glm::dmat4 after = grab.world_from_node();
            ASSERT_LT(max_difference(after, before), max) << seed << " " << i << " " << event;
            ASSERT_GT(grab.scale(), 0.2 * (1 - 1e-9));
            ASSERT_LT(grab.scale(), 4 * (1 + 1e-9));
            const glm::dmat4 step = after * glm::inverse(before);
            ASSERT_LT(std::abs(upright ? step[1].x : 0) + std::abs(upright ? step[1].z : 0), 1e-6);
        }
    }
}

TEST(Grab, ContinuesSmoothlyThroughTheVerticalAndThroughEachOther) {
    for (const xr::GrabSettings& settings : {kFree, kUpright}) {
        xr::Grab grab(glm::dmat4(1), settings);
        grab.attach(0, {});
        grab.attach(1, {{1, 0, 0}});
        glm::dmat4 before = grab.world_from_node();
        for (int i = 0; i < 20000; ++i) {
            // The line swings over the top, close to the vertical, and at times shrinks to less than a centimetre.
            const double t = i * 1e-3, length = 0.5 + 0.499 * std::cos(t * 1.3);
            grab.move(1, {length * glm::dvec3(std::cos(t), std::sin(t), 0.05 * std::sin(2 * t))});
            const glm::dmat4 after = grab.world_from_node();
            ASSERT_LT(max_difference(after, before), 0.05) << i;
            before = after;
        }
    }
}

TEST(Grab, AHandThatTipsOverSpinsNothing) {
    const auto tipped = [](double t) {
        return xr::Pose{
            {}, glm::angleAxis(t, glm::dvec3(1, 0, 0)) * glm::angleAxis(0.05 * std::sin(t / 3), glm::dvec3(0, 0, 1))};
    };
    xr::Grab grab(glm::dmat4(1), kUpright);
    grab.attach(0, tipped(0));
    glm::dmat4 before = grab.world_from_node();
    for (double t = 0; t < 20; t += 0.01) {
        grab.move(0, tipped(t));
        const glm::dmat4 after = grab.world_from_node();
        ASSERT_LT(max_difference(after, before), 0.05) << t;
        before = after;
    }
}

TEST(Grab, ScaleStaysWithinItsLimitsSinceTheStart) {
    xr::Grab grab(glm::scale(glm::dmat4(1), glm::dvec3(3)), {.upright = true, .min_scale = 0.5, .max_scale = 2});
    for (int round = 0; round < 3; ++round) {  // the limits hold for all rounds together
        grab.attach(0, {{-0.1, 1, 0}});
        grab.attach(1, {{0.1, 1, 0}});
        move_and_wait(grab, 1, {{5, 1, 0}});
        EXPECT_NEAR(grab.scale(), 2, 1e-12);
        EXPECT_NEAR(glm::length(glm::dvec3(grab.world_from_node()[0])), 6, 1e-12);
        grab.detach(0);
        grab.detach(1);
    }
    grab.attach(0, {{-5, 1, 0}});
    grab.attach(1, {{5, 1, 0}});
    move_and_wait(grab, 1, {{-4.9, 1, 0}});
    EXPECT_NEAR(grab.scale(), 0.5, 1e-12);
    EXPECT_NEAR(glm::length(glm::dvec3(grab.world_from_node()[0])), 1.5, 1e-12);
}

TEST(Grab, HandsAtOnePlaceDoNotScale) {
    xr::Grab grab(glm::dmat4(1), kFree);
    grab.attach(0, {});
    grab.attach(1, {{0.001, 0, 0}});
    EXPECT_LT(max_difference(grab.world_from_node(), glm::dmat4(1)), 1e-12);
    move_and_wait(grab, 1, {{0, 0.015, 0}});
    EXPECT_NEAR(grab.scale(), 1, 1e-12);
    EXPECT_LT(max_difference(grab.world_from_node(), glm::translate(glm::dmat4(1), {-0.0005, 0.0075, 0})), 1e-12);
    move_and_wait(grab, 1, {});
    EXPECT_LT(max_difference(grab.world_from_node(), glm::translate(glm::dmat4(1), {-0.0005, 0, 0})), 1e-12)
        << "the same place";
    move_and_wait(grab, 1, {{0.2, 0, 0}});
    EXPECT_NEAR(grab.scale(), 0.2 / xr::Grab::kMinApart_m, 1e-9);
}

TEST(Grab, ReachesAlongTheHand) {
    const xr::Pose hand = {{0, 1, 0}, xr::turn_by(glm::radians(90.0))};  // looks along −X
    xr::Grab grab(glm::dmat4(1), kUpright);
    grab.attach(0, hand, 2);
    grab.push(0, 0.5);
    EXPECT_LT(max_difference(grab.world_from_node(), glm::translate(glm::dmat4(1), {-0.5, 0, 0})), 1e-12);
    EXPECT_NEAR(grab.distance_m(0), 2.5, 1e-12);
    grab.push(0, -100);
    EXPECT_NEAR(grab.distance_m(0), xr::Grab::kMinDistance_m, 1e-12);
    EXPECT_LT(max_difference(grab.world_from_node(), glm::translate(glm::dmat4(1), {1.9, 0, 0})), 1e-12);
    // The node still follows the ray, at the distance that it has been pulled to.
    grab.move(0, {{0, 1, 0}, {1, 0, 0, 0}});
    const glm::dvec3 at = carried(glm::dmat4(1), grab.world_from_node(), {-2, 1, 0});
    EXPECT_LT(glm::distance(at, {0, 1, -0.1}), 1e-12);
    grab.push(1, 5);
    grab.attach(1, {{1, 1, 0}}, 0.03);
    const glm::dmat4 before = grab.world_from_node();
    grab.push(0, 5);
    EXPECT_EQ(max_difference(grab.world_from_node(), before), 0) << "two hands hold it";
    grab.detach(0);
    grab.push(1, -1);
    EXPECT_LT(max_difference(grab.world_from_node(), before), 1e-12)
        << "nearer than the nearest, it is not pushed away either";
}

TEST(Grab, IgnoresWhatIsNoPose) {
    for (const xr::GrabSettings& settings : {kFree, kUpright}) {
        RandomPoses random(14);
        xr::Grab grab(glm::dmat4(1), settings);
        for (const xr::Pose& pose : test::invalid_poses()) grab.attach(0, pose);
        for (const double bad : {kNan, kInfinite, -kInfinite, -0.5}) grab.attach(0, {}, bad);
        EXPECT_TRUE(grab.empty());
        grab.move(0, random.pose());
        grab.detach(0);
        grab.push(0, 1);
        EXPECT_EQ(max_difference(grab.world_from_node(), glm::dmat4(1)), 0) << "nobody holds it";
        grab.attach(0, random.pose(), 1);
        grab.attach(1, random.pose(), 1);
        grab.move(0, random.pose());
        const glm::dmat4 before = grab.world_from_node();
        for (const int hand : {0, 1})
            for (const xr::Pose& pose : test::invalid_poses()) grab.move(hand, pose);
        grab.detach(1);
        for (const double bad : {kNan, kInfinite, -kInfinite}) grab.push(0, bad);
        EXPECT_LT(max_difference(grab.world_from_node(), before), 1e-12);
    }
}

TEST(Grab, StaysFiniteWhateverTheHandsDo) {
    for (uint32_t seed = 0; seed < 20; ++seed) {
        RandomPoses random(200 + seed);
        xr::Grab grab(random_node(random), {.upright = seed % 2 == 0});
        const double max_m = seed < 10 ? 1 : 1e-3;
        for (int i = 0; i < 1000; ++i) {
            const int hand = random.number(0, 1) < 0.5 ? 0 : 1;
            const double event = random.number(0, 1);
            if (event < 0.1) grab.attach(hand, random.pose(max_m), random.number(0, max_m));
            if (event > 0.9) grab.detach(hand);
            grab.move(hand, random.pose(max_m));
            const glm::dmat4 node = grab.world_from_node();
            ASSERT_LT(max_difference(node, glm::dmat4(0)), 1e4) << seed << " " << i;
            ASSERT_GE(grab.scale(), 0.05 * (1 - 1e-9));
            ASSERT_LE(grab.scale(), 50 * (1 + 1e-9));
        }
    }
}

TEST(Floor, TheLowestCornerStandsOnIt) {
    RandomPoses random(15);
    const glm::dvec3 low(-0.4, 0.1, -0.3), high(0.5, 1.7, 0.3);
    for (int i = 0; i < 100; ++i) {
        const glm::dmat4 node = random_node(random);
        const double floor_y = random.number(-2, 2);
        const glm::dmat4 standing = on_floor(node, low, high, floor_y);
        double lowest = kInfinite, was = kInfinite;
        for (unsigned corner = 0; corner < 8; ++corner) {
            const glm::dvec4 at((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                                (corner & 4) != 0 ? high.z : low.z, 1);
            lowest = std::min(lowest, (standing * at).y);
            was = std::min(was, (node * at).y);
        }
        EXPECT_NEAR(lowest, floor_y, 1e-12);
        EXPECT_LT(max_difference(glm::translate(glm::dmat4(1), {0, floor_y - was, 0}) * node, standing), 1e-12)
            << "only that";
        EXPECT_NEAR(above_floor(node, low, high, floor_y), was - floor_y, 1e-12);
    }
}

TEST(Floor, StaysWhereThereIsNone) {
    const glm::dmat4 node = glm::translate(glm::dmat4(1), {1, 2, 3});
    for (const double bad : {kNan, kInfinite, -kInfinite}) {
        EXPECT_EQ(max_difference(on_floor(node, {0, 0, 0}, {1, 1, 1}, bad), node), 0);
        EXPECT_EQ(max_difference(on_floor(node, {0, bad, 0}, {1, bad, 1}, 0), node), 0);
        EXPECT_FALSE(std::isfinite(above_floor(node, {0, 0, 0}, {1, 1, 1}, bad)));
        EXPECT_FALSE(std::isfinite(above_floor(node, {0, bad, 0}, {1, bad, 1}, 0)));
    }
}

}  // namespace
}  // namespace neuvv

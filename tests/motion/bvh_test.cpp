// BVH files that other programs wrote.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/input_error.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv::motion_files_test {
namespace {

using motion::Joint;

// A body of CMU's names in centimetres; frame 0 at rest, frame 1 moved, turned by 90° about +Y, the left forearm up.
constexpr const char* kBvh = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 100 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT LeftUpLeg
  { OFFSET 10 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT LeftLeg { OFFSET 0 -45 0 CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT LeftFoot { OFFSET 0 -45 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 -5 12 } } } }
  JOINT RightUpLeg
  { OFFSET -10 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT RightLeg { OFFSET 0 -45 0 CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT RightFoot { OFFSET 0 -45 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 -5 12 } } } }
  JOINT Spine
  { OFFSET 0 45 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT Head { OFFSET 0 15 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 15 0 } }
    JOINT LeftArm { OFFSET 20 0 0 CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT LeftForeArm { OFFSET 28 0 0 CHANNELS 3 Zrotation Xrotation Yrotation
        JOINT LeftHand { OFFSET 25 0 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 8 0 0 } } } }
    JOINT RightArm { OFFSET -20 0 0 CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT RightForeArm { OFFSET -28 0 0 CHANNELS 3 Zrotation Xrotation Yrotation
        JOINT RightHand { OFFSET -25 0 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET -8 0 0 } } } } }
}
MOTION
Frames: 2
Frame Time: 0.0333333
)";

constexpr size_t kBvhChannels = 6 + 3 * 14;

constexpr size_t kLeftForearmChannel = 6 + 3 * 9;

std::string bvh_frame(double x, double turn_y, double forearm_z) {
    std::string line;
    for (size_t i = 0; i < kBvhChannels; ++i)
        line += fmt::format("{} ", i == 0                     ? x
                                   : i == 1                   ? 100
                                   : i == 5                   ? turn_y
                                   : i == kLeftForearmChannel ? forearm_z
                                                              : 0.0);
    return line + "\r\n";
}

TEST(Bvh, GivesMetresAndFollowsItsChannels) {
    const TemporaryFolder folder;
    const auto path = folder.path / "take.BVH";
    write_text(path, kBvh + bvh_frame(0, 0, 0) + bvh_frame(50, 90, 90));
    const motion::SkeletonClip clip = motion::read_skeleton(path);
    ASSERT_EQ(clip.frames.size(), 2u);
    EXPECT_DOUBLE_EQ(clip.fps, 30);
    test::expect_near(motion::at(clip.frames[0], Joint::kPelvis).position, {0, 1, 0});
    test::expect_near(motion::at(clip.frames[0], Joint::kLeftWrist).position, {0.73, 1.45, 0});
    EXPECT_GT(motion::at(clip.frames[0], Joint::kRightBigToe).position.z, 0.1);
    // Turned by 90° about +Y, left (+X) is −Z; the forearm, turned about its own Z, points up.
    test::expect_near(motion::at(clip.frames[1], Joint::kLeftElbow).position, {0.5, 1.45, -0.48});
    test::expect_near(motion::at(clip.frames[1], Joint::kLeftWrist).position, {0.5, 1.70, -0.48});
    test::expect_near(motion::at(clip.frames[1], Joint::kRightKnee).position, {0.5, 0.55, 0.1});
}

// The writer against the reader, which the tests above check by hand.
TEST(Bvh, IsReadAsItWasWritten) {
    constexpr double kWithin_m = 2e-6;
    const TemporaryFolder folder;
    const auto path = folder.path / "a.bvh";
    for (const auto& [units, scale] : {std::pair(1.0, 1.0), {100.0, 1.0}, {1.0, 0.3}}) {  // the last one is a doll
        motion::SkeletonClip clip = test::performer_motion(30);
        for (motion::Pose& pose : clip.frames)
            for (motion::JointSample& sample : pose) sample.position *= scale;
        motion::write_bvh(path, clip, units);
        const motion::SkeletonClip read = motion::read_skeleton(path);
        EXPECT_DOUBLE_EQ(read.fps, clip.fps);
        ASSERT_EQ(read.frames.size(), clip.frames.size());
        for (size_t f = 0; f < clip.frames.size(); ++f)
            for (size_t j = 0; j < motion::kJoints; ++j) {
                test::expect_near(read.frames[f][j].position, clip.frames[f][j].position, kWithin_m);
                EXPECT_TRUE(read.frames[f][j].measured);
            }
    }
}

TEST(Bvh, KeepsAJointThatAFrameDoesNotKnow) {
    const TemporaryFolder folder;
    motion::SkeletonClip clip = test::performer_motion(3);
    motion::at(clip.frames[1], Joint::kLeftWrist) = {glm::dvec3(5), 0, false};
    motion::write_bvh(folder.path / "a.bvh", clip, 1);
    const motion::SkeletonClip read = motion::read_skeleton(folder.path / "a.bvh");
    test::expect_near(motion::at(read.frames[1], Joint::kLeftWrist).position,
                      motion::at(clip.frames[0], Joint::kLeftWrist).position, 2e-6);
}

// Programs mix frames by their angles.
TEST(Bvh, HasNoJumpsInItsAngles) {
    const TemporaryFolder folder;
    motion::SkeletonClip clip = test::performer_motion(1);
    clip.frames.resize(50, clip.frames[0]);
    for (size_t f = 0; f < clip.frames.size(); ++f)  // two turns about +Y
        for (motion::JointSample& sample : clip.frames[f]) {
            const double angle = 4 * std::numbers::pi * static_cast<double>(f) / 49;
            const glm::dvec3 p = sample.position;
            sample.position = {std::cos(angle) * p.x + std::sin(angle) * p.z, p.y,
                               std::cos(angle) * p.z - std::sin(angle) * p.x};
        }
    motion::write_bvh(folder.path / "a.bvh", clip, 1);
    std::istringstream text(read_text(folder.path / "a.bvh"));
    std::string line;
    while (line.find("Frame Time") == std::string::npos) ASSERT_TRUE(std::getline(text, line));
    double turned = 0;
    std::vector<double> before;
    while (std::getline(text, line)) {
        std::istringstream words(line);
        const std::vector<double> values{std::istream_iterator<double>(words), {}};
        for (size_t i = 3; i < 6 && !before.empty(); ++i) EXPECT_LT(std::abs(values[i] - before[i]), 30);
        if (!before.empty()) turned += values[5] - before[5];
        before = values;
    }
    EXPECT_NEAR(turned, 720, 1e-3);
}

TEST(Bvh, RefusesWhatIsNotWhole) {
    const TemporaryFolder folder;
    const auto path = folder.path / "take.bvh";
    const auto refuses = [&](const std::string& text, std::initializer_list<std::string> parts) {
        write_text(path, text);
        expect_input_error([&] { motion::read_skeleton(path); }, parts);
    };
    const std::string head = kBvh;
    refuses(head + bvh_frame(0, 0, 0), {"take.bvh", "line", "ends too early"});
    refuses(head + bvh_frame(0, 0, 0) + "0 nan 0", {"take.bvh", "line 31", "nan"});
    refuses("HIERARCHY\nROOT a { OFFSET 0 0 0 CHANNELS 0 } MOTION Frames: 1 Frame Time: 1\n",
            {"take.bvh", "no channels"});
    refuses("HIERARCHY\nROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition } MOTION Frames: 1 Frame Time: 1\n0\n",
            {"take.bvh", "no bones", "right foot"});
    refuses("HIERARCHY\nROOT a { OFFSET 0 0 0 CHANNELS 7", {"take.bvh", "line 2", "\"7\""});
    refuses("HIERARCHY\nROOT a { OFFSET 0 0 0 CHANNELS 1 Wposition", {"Wposition", "no channel"});
    refuses("hello", {"take.bvh", "line 1", "HIERARCHY"});
}

// 3ds Max has spaces in names; editors of Windows begin files with a byte order mark.
TEST(Bvh, MayHaveSpacesInNamesAndAByteOrderMark) {
    const TemporaryFolder folder;
    const auto path = folder.path / "take.bvh";
    std::string text = kBvh + bvh_frame(0, 0, 0) + bvh_frame(0, 0, 0);
    const std::pair<const char*, const char*> names[] = {
        {"LeftUpLeg", "Bip01 L Thigh"},  {"LeftLeg {", "Bip01 L Calf{"},   {"LeftFoot", "Bip01 L Foot"},
        {"RightUpLeg", "Bip01 R Thigh"}, {"RightLeg", "Bip01 R Calf"},     {"RightFoot", "Bip01 R Foot"},
        {"Head", "Bip01  Head"},         {"LeftArm", "Bip01 L UpperArm"},  {"LeftForeArm", "Bip01 L Forearm"},
        {"LeftHand", "Bip01 L Hand"},    {"RightArm", "Bip01 R UpperArm"}, {"RightForeArm", "Bip01 R Forearm"},
        {"RightHand", "Bip01 R Hand"},   {"ROOT Hips", "ROOT Bip01"},      {"End Site", "End site"},
        {"CHANNELS 6 X", "Channels 6 X"}};
    for (const auto& [from, to] : names) text.replace(text.find(from), std::string(from).size(), to);
    write_text(path, "\xef\xbb\xbf" + text);
    const motion::SkeletonClip clip = motion::read_skeleton(path);
    test::expect_near(motion::at(clip.frames[0], Joint::kLeftWrist).position, {0.73, 1.45, 0});
    test::expect_near(motion::at(clip.frames[0], Joint::kRightKnee).position, {-0.1, 0.55, 0});
    write_text(path, "\xff\xfeH");
    expect_input_error([&] { motion::read_skeleton(path); }, {"take.bvh", "UTF-16", "UTF-8"});
    write_text(path, "HIERARCHY\nROOT OFFSET 0 0 0");
    expect_input_error([&] { motion::read_skeleton(path); }, {"take.bvh", "line 2", "OFFSET"});
}

}  // namespace
}  // namespace neuvv::motion_files_test

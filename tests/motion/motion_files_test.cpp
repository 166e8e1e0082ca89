// Skeletons and key points that other programs wrote.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>

#include "motion/detector.h"
#include "motion/live/pose_line.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/input_error.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv {
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

std::string trc_row(int frame, const std::vector<glm::dvec3>& places) {
    std::string row = fmt::format("{}\t{}", frame, (frame - 1) / 60.0);
    for (const glm::dvec3& p : places) row += fmt::format("\t{}\t{}\t{}", p.x, p.y, p.z);
    return row + "\n";
}

TEST(Trc, ReadsMarkersByName) {
    const TemporaryFolder folder;
    const auto path = folder.path / "take.trc";
    const std::string head =
        "PathFileType\t4\t(X/Y/Z)\ttake.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n60\t60\t2\t5\tmm\n"
        "Frame#\tTime\tHip\t\t\tNeck\t\t\tRHip\t\t\tRKnee\t\t\tRAnkle\t\t\tRBigToe\n\t\tX1\tY1\tZ1\n";
    const std::vector<glm::dvec3> places = {
        {0, 1000, 0}, {0, 1500, 0}, {-100, 1000, 0}, {-100, 550, 0}, {-100, 100, 0}};
    std::string rows = trc_row(1, places) + trc_row(2, places);
    rows.insert(rows.find('\n'), "\t-100\t0\t150");
    rows.insert(rows.size() - 1, "\tnan\t\t");
    write_text(path, head + rows);
    const motion::SkeletonClip clip = motion::read_skeleton(path);
    ASSERT_EQ(clip.frames.size(), 2u);
    EXPECT_DOUBLE_EQ(clip.fps, 60);
    test::expect_near(motion::at(clip.frames[0], Joint::kRightKnee).position, {-0.1, 0.55, 0});
    test::expect_near(motion::at(clip.frames[0], Joint::kRightBigToe).position, {-0.1, 0, 0.15});
    EXPECT_EQ(motion::at(clip.frames[1], Joint::kRightBigToe).confidence, 0);
    EXPECT_EQ(motion::at(clip.frames[0], Joint::kLeftKnee).confidence, 0);
    EXPECT_TRUE(motion::at(clip.frames[0], Joint::kNeck).measured);

    const auto refuses = [&](const std::string& text, std::initializer_list<std::string> parts) {
        write_text(path, text);
        expect_input_error([&] { motion::read_skeleton(path); }, parts);
    };
    refuses(head, {"take.trc", "no frames"});
    refuses(head + "1\t0\t0\tx\t0\n", {"take.trc", "line 6"});
    std::string inches = head;
    refuses(inches.replace(inches.find("mm"), 2, "in") + rows, {"take.trc", "\"in\"", "unit"});
    refuses("PathFileType", {"take.trc", "head"});
}

// Markers of a Kinect, which has ankle and foot, in a space whose +Z is up, without a pelvis and a neck.
TEST(Trc, KnowsOtherNamesAndStandsBodiesUp) {
    const TemporaryFolder folder;
    const auto path = folder.path / "take.trc";
    const std::pair<const char*, glm::dvec3> markers[] = {
        {"HipRight", {-10, 0, 95}},     {"KneeRight", {-10, 0, 50}}, {"FootRight", {-10, -15, 0}},
        {"AnkleRight", {-10, 0, 8}},    {"HipLeft", {10, 0, 95}},    {"KneeLeft", {10, 0, 50}},
        {"FootLeft", {10, -15, 0}},     {"AnkleLeft", {10, 0, 8}},   {"ShoulderRight", {-18, 0, 140}},
        {"ShoulderLeft", {18, 0, 140}}, {"HandLeft", {60, 0, 140}},  {"WristLeft", {50, 0, 140}}};
    std::string names = "Frame#\tTime";
    std::vector<glm::dvec3> places;
    for (const auto& [name, place] : markers) {
        names += fmt::format("\t{}\t\t", name);
        places.push_back(place);
    }
    write_text(path, "\xef\xbb\xbfPathFileType\t4\t(X/Y/Z)\ttake.trc\nDataRate\tUnits\n60\tCM\n" + names +
                         "\n\t\tX1\tY1\tZ1\n" + trc_row(1, places));
    const motion::SkeletonClip clip = motion::read_skeleton(path);
    test::expect_near(motion::at(clip.frames[0], Joint::kPelvis).position, {0, 0.95, 0});
    test::expect_near(motion::at(clip.frames[0], Joint::kNeck).position, {0, 1.4, 0});
    test::expect_near(motion::at(clip.frames[0], Joint::kLeftWrist).position, {0.5, 1.4, 0});
    test::expect_near(motion::at(clip.frames[0], Joint::kRightAnkle).position, {-0.1, 0.08, 0});
    ASSERT_EQ(clip.notes.size(), 1u);
    EXPECT_NE(clip.notes[0].find("take.trc: the body stands along z"), std::string::npos) << clip.notes[0];
    motion::SkeletonReading lying;
    lying.up = motion::Axis::kY;
    test::expect_near(motion::at(motion::read_skeleton(path, lying).frames[0], Joint::kNeck).position, {0, 0, 1.4});
}

TEST(Trc, OfPose2SimStands) {
    const std::filesystem::path data = NEUVV_SOURCE_DIR "/../shared/data/pose2sim/single/pose-3d";
    if (!std::filesystem::is_directory(data)) GTEST_SKIP() << "no ../shared/data/pose2sim";
    for (const auto& file : std::filesystem::directory_iterator(data)) {
        const motion::SkeletonClip clip = motion::read_skeleton(file.path());
        EXPECT_TRUE(clip.notes.empty()) << clip.notes.at(0);
        EXPECT_EQ(motion::standing_axis(clip), motion::Axis::kY);
        EXPECT_NEAR(test::height_of(clip), 1.7, 0.2);
    }
}

TEST(PoseLine, IsReadAsItWasWritten) {
    motion::TimedPose pose{12.5, test::performer_motion(1).frames[0]};
    motion::at(pose.pose, Joint::kLeftHeel) = {};
    motion::at(pose.pose, Joint::kNose).confidence = 0.25;
    motion::at(pose.pose, Joint::kRightBigToe).measured = false;
    const motion::TimedPose read = motion::read_pose_line(motion::pose_line(pose), "stdin");
    EXPECT_EQ(read.time_s, 12.5);
    for (size_t j = 0; j < motion::kJoints; ++j) {
        EXPECT_EQ(read.pose[j].confidence, pose.pose[j].confidence) << j;
        EXPECT_EQ(read.pose[j].measured, pose.pose[j].measured) << j;
        const bool known = pose.pose[j].confidence > 0;
        EXPECT_EQ(read.pose[j].position, known ? pose.pose[j].position : glm::dvec3(0)) << j;
    }
}

TEST(PoseLine, RefusesWhatIsNoPose) {
    const auto refuses = [](const std::string& line, std::initializer_list<std::string> parts) {
        expect_input_error([&] { motion::read_pose_line(line, "stdin"); }, parts);
    };
    refuses("", {"stdin", "no JSON object"});
    refuses("[1]", {"no JSON object"});
    refuses("{\"time\": 1", {"no JSON object"});
    refuses("{\"joints\": {}}", {"time"});
    refuses("{\"time\": \"now\", \"joints\": {}}", {"time"});
    refuses("{\"time\": 1, \"joints\": []}", {"joints", "object"});
    refuses("{\"time\": 1, \"joints\": {\"tail\": [0, 0, 0]}}", {"tail", "no joint"});
    refuses("{\"time\": 1, \"joints\": {\"nose\": [0, 0]}}", {"joints.nose", "[x, y, z]"});
    refuses("{\"time\": 1, \"joints\": {\"nose\": [0, 1e300, 0]}}", {"joints.nose[1]"});
    refuses("{\"time\": 1, \"joints\": {\"nose\": [0, 1, 0, 2]}}", {"joints.nose[3]", "confidence"});
    refuses("{\"time\": 1, \"joints\": {}, \"estimated\": [\"tail\"]}", {"tail"});
    refuses("{\"time\": 1, \"joints\": {}, \"person\": [1]}", {"person", "string"});
    refuses(std::string(100000, ' '), {"64 KiB"});
}

motion::KeyPoints some_points(double shift) {
    motion::KeyPoints points;
    for (size_t j = 0; j < motion::kJoints; ++j) points[j] = {{10.5 * double(j) + shift, 7}, 0.5};
    return points;
}

struct DetectionFolder {
    TemporaryFolder folder;
    motion::Detections detections;
    std::vector<motion::WantedImage> images;

    DetectionFolder() {
        detections.cameras.resize(2);
        detections.frames = 3;
        for (size_t c = 0; c < 2; ++c)
            for (size_t f = 0; f < 3; ++f)
                images.push_back({fmt::format("c0{}", c), fmt::format("c0{}_f00{}", c, f), c, f});
    }
    void read() { motion::read_detections(folder.path, images, detections); }
};

TEST(KeyPoints, AreReadByTheNamesOfImages) {
    DetectionFolder test;
    motion::write_key_points(test.folder.path / "c00_f001_keypoints.json", some_points(0));
    motion::write_key_points(test.folder.path / "c01_f002.json", some_points(3));
    test.read();
    for (size_t j = 0; j < motion::kJoints; ++j) {
        EXPECT_EQ(test.detections.in(1, 0)[j].pixel, some_points(0)[j].pixel) << j;
        EXPECT_EQ(test.detections.in(2, 1)[j].pixel, some_points(3)[j].pixel) << j;
        EXPECT_EQ(test.detections.in(0, 0)[j].confidence, 0);
        EXPECT_FALSE(test.detections.lacking[j]);
    }
    motion::write_key_points(test.folder.path / "c09_f001.json", some_points(0));
    expect_input_error([&] { test.read(); }, {"c09_f001.json", "no image"});
}

TEST(KeyPoints, AreReadFromAFolderForEachCamera) {
    DetectionFolder test;
    std::filesystem::create_directory(test.folder.path / "c01_json");
    for (const char* name : {"000000", "000001", "000002"})
        motion::write_key_points(test.folder.path / "c01_json" / (std::string(name) + ".json"), some_points(name[5]));
    test.read();
    EXPECT_EQ(test.detections.in(2, 1)[0].pixel.x, '2');
    // Names are in the order of their numbers.
    for (const char* name : {"000001", "000002"})
        std::filesystem::remove(test.folder.path / "c01_json" / (std::string(name) + ".json"));
    motion::write_key_points(test.folder.path / "c01_json" / "f9.json", some_points('9'));
    motion::write_key_points(test.folder.path / "c01_json" / "f10.json", some_points('1'));
    test.read();
    EXPECT_EQ(test.detections.in(1, 1)[0].pixel.x, '9');
    EXPECT_EQ(test.detections.in(2, 1)[0].pixel.x, '1');
    motion::write_key_points(test.folder.path / "c01_json" / "000003.json", some_points(0));
    expect_input_error([&] { test.read(); }, {"c01_json", "has 4 frames, but the camera has 3"});
    std::filesystem::remove(test.folder.path / "c01_json" / "000003.json");
    std::filesystem::create_directory(test.folder.path / "c01");
    expect_input_error([&] { test.read(); }, {"the same camera"});
    std::filesystem::remove(test.folder.path / "c01");
    std::filesystem::create_directory(test.folder.path / "c07_json");
    expect_input_error([&] { test.read(); }, {"c07_json", "none of these cameras"});
}

// Detectors that write nothing where they see nobody: a file that is missing is an image without a person.
TEST(KeyPoints, GoByTheNumbersOfTheirFiles) {
    DetectionFolder test;
    const auto write = [&](const std::string& folder, const std::string& name, double shift) {
        std::filesystem::create_directory(test.folder.path / folder);
        motion::write_key_points(test.folder.path / folder / (name + ".json"), some_points(shift));
    };
    const auto expect_seen = [&](std::array<std::array<int, 3>, 2> shifts) {
        test.detections.notes.clear();
        test.read();
        for (size_t c = 0; c < 2; ++c)
            for (size_t f = 0; f < 3; ++f) {
                const motion::KeyPoint nose = test.detections.in(f, c)[motion::index_of(Joint::kNose)];
                if (shifts[c][f] < 0)
                    EXPECT_EQ(nose.confidence, 0) << c << f;
                else
                    EXPECT_EQ(nose.pixel.x, 10.5 * 2 + shifts[c][f]) << c << f;
            }
    };
    const auto begin_anew = [&] {
        for (const auto& entry : std::filesystem::directory_iterator(test.folder.path))
            std::filesystem::remove_all(entry.path());
    };
    // Pose2Sim's folders with the names of OpenPose, of its own demo, of MMPose and of AlphaPose.
    const std::pair<const char*, const char*> schemes[] = {
        {"c00_f000_keypoints", "c00_f002_keypoints"},
        {"video_000000000000_keypoints", "video_000000000002_keypoints"},
        {"cam01.0000", "cam01.0002"},
        {"000000", "000002"},
        {"0", "2.jpg"}};
    for (const auto& [first, third] : schemes) {
        SCOPED_TRACE(first);
        write("c00_json", first, 1);
        write("c00_json", third, 3);
        write("c01_json", "c01_f001", 5);
        write("c01_json", ".hidden_f000", 9);
        expect_seen({{{1, -1, 3}, {-1, 5, -1}}});
        ASSERT_EQ(test.detections.notes.size(), 1u);
        EXPECT_NE(test.detections.notes[0].find("3 of 6 images"), std::string::npos) << test.detections.notes[0];
        begin_anew();
    }
    // A detector that counts from another number in all cameras.
    write("c00_json", "00101", 1);
    write("c00_json", "00103", 3);
    write("c01_json", "00102", 5);
    expect_seen({{{1, -1, 3}, {-1, 5, -1}}});
    EXPECT_NE(test.detections.notes[0].find("numbered from 101, images from 0"), std::string::npos);
    // Numbers that fit in no way.
    write("c01_json", "00110", 5);
    expect_input_error([&] { test.read(); }, {"belongs to no image", "c00_f000_keypoints.json"});
    begin_anew();
    write("c00_json", "f1", 1);
    write("c00_json", "f01", 1);
    expect_input_error([&] { test.read(); }, {"has the number of"});
    begin_anew();
    // All files in one folder, with more zeros than the images' names have.
    write(".", "c00_f000000002_keypoints", 3);
    write(".", "c01_f000000000_keypoints", 4);
    expect_seen({{{-1, -1, 3}, {4, -1, -1}}});
    begin_anew();
    // Folders that bear no camera's name are taken in order, as Pose2Sim does.
    write("cam_1_json", "000", 1);
    write("cam_2_json", "002", 2);
    expect_seen({{{1, -1, -1}, {-1, -1, 2}}});
    EXPECT_NE(test.detections.notes[0].find("cam_1 for c00"), std::string::npos) << test.detections.notes[0];
}

std::string paired_person(double x) {
    std::string places, scores;
    for (int i = 0; i < 17; ++i) {
        places += fmt::format("{}[{}, {}]", i ? ", " : "", x, 2 * i);
        scores += fmt::format("{}{}", i ? ", " : "", 0.5);
    }
    return "{\"keypoints\": [" + places + "], \"keypoint_scores\": [" + scores + "]}";
}

TEST(KeyPoints, OfMMPoseAndAlphaPoseAreRead) {
    DetectionFolder test;
    const auto nose_x = [&](size_t frame, size_t camera) {
        const motion::KeyPoint& nose = test.detections.in(frame, camera)[motion::index_of(Joint::kNose)];
        return nose.confidence > 0 ? nose.pixel.x : -1;
    };
    write_text(test.folder.path / "c00_f001.json", "[" + paired_person(4) + "]");
    write_text(test.folder.path / "c00_f002.json", "[]");
    test.read();
    EXPECT_EQ(nose_x(1, 0), 4);
    EXPECT_EQ(nose_x(2, 0), -1);
    // MMPose's file of a video, of each camera.
    write_text(test.folder.path / "c00_f001.json", "[]");
    write_text(test.folder.path / "results_c00.json",
               "{\"meta_info\": {}, \"instance_info\": [{\"frame_id\": 0, \"instances\": [" + paired_person(5) +
                   "]}, {\"frame_id\": 2, \"instances\": []}]}");
    write_text(test.folder.path / "c01.json", "[{\"frame_id\": 2, \"instances\": [" + paired_person(6) + "]}]");
    test.read();
    EXPECT_EQ(nose_x(0, 0), 5);
    EXPECT_EQ(nose_x(2, 1), 6);
    // AlphaPose's file of all images.
    for (const char* name : {"c00_f001.json", "c00_f002.json", "results_c00.json", "c01.json"})
        std::filesystem::remove(test.folder.path / name);
    std::string flat;
    for (int i = 0; i < 17; ++i) flat += fmt::format("{}{}, 3, 0.9", i ? ", " : "", 8);
    const auto of_image = [&](const char* name, const std::string& points) {
        return fmt::format("{{\"image_id\": \"{}\", \"category_id\": 1, \"keypoints\": [{}], \"score\": 2.5}}", name,
                           points);
    };
    write_text(test.folder.path / "alphapose-results.json",
               "[" + of_image("c00_f000.jpg", flat) + "," + of_image("c01_f002.jpg", flat) + "]");
    test.read();
    EXPECT_EQ(nose_x(0, 0), 8);
    EXPECT_EQ(nose_x(2, 1), 8);
    EXPECT_EQ(nose_x(1, 0), -1);
    write_text(test.folder.path / "alphapose-results.json", "[" + of_image("c07_f000.jpg", flat) + "]");
    expect_input_error([&] { test.read(); }, {"alphapose-results.json", "c07_f000", "no image"});
}

// OpenPose has two sets of 25 points; Pose2Sim's demo is of the rarer one.
TEST(KeyPoints, OfBody25BAreTold) {
    const std::filesystem::path data = NEUVV_SOURCE_DIR "/../shared/data/pose2sim/single/pose";
    if (!std::filesystem::is_directory(data)) GTEST_SKIP() << "no ../shared/data/pose2sim";
    motion::Detections seen;
    seen.cameras.resize(4);
    seen.frames = 100;
    std::vector<motion::WantedImage> images;
    for (size_t c = 0; c < 4; ++c)
        for (size_t f = 0; f < 100; ++f)
            images.push_back({fmt::format("cam0{}", c + 1), fmt::format("cam0{}_{:06}", c + 1, f), c, f});
    motion::read_detections(data, images, seen);
    // Ankles are below knees, and these below hips; of BODY_25 the numbers of the hips are a wrist and an elbow.
    size_t right = 0, wrong = 0;
    for (const motion::KeyPoints& points : seen.points) {
        const auto at = [&](Joint joint) { return points[motion::index_of(joint)]; };
        if (!(at(Joint::kRightHip).confidence > 0.5 && at(Joint::kRightKnee).confidence > 0.5 &&
              at(Joint::kNeck).confidence > 0.5))
            continue;
        const bool ordered = at(Joint::kNeck).pixel.y < at(Joint::kRightHip).pixel.y &&
                             at(Joint::kRightHip).pixel.y < at(Joint::kRightKnee).pixel.y;
        ++(ordered ? right : wrong);
    }
    EXPECT_GT(right, 300u);
    EXPECT_LT(wrong, 10u);
}

TEST(KeyPoints, OfImagesWithOneNameNeedFolders) {
    DetectionFolder test;
    for (motion::WantedImage& image : test.images) image.image = "0001";
    motion::write_key_points(test.folder.path / "0001.json", some_points(0));
    expect_input_error([&] { test.read(); }, {"several cameras", "0001", "folder for each camera"});
}

std::string person(size_t points, double confidence) {
    std::string list;
    for (size_t i = 0; i < points; ++i) list += fmt::format("{}{}, {}, {}", i ? ", " : "", i, 2 * i, confidence);
    return "{\"pose_keypoints_2d\": [" + list + "]}";
}

TEST(KeyPoints, OfTheMostConfidentPersonCount) {
    DetectionFolder test;
    const auto path = test.folder.path / "c00_f000.json";
    write_text(path, "{\"people\": [" + person(17, 0.25) + "," + person(17, 0.75) + "," + person(17, 0.5) + "]}");
    test.read();
    EXPECT_EQ(test.detections.images_with_others, 1u);
    const motion::KeyPoints& found = test.detections.in(0, 0);
    EXPECT_EQ(found[motion::index_of(Joint::kLeftWrist)].pixel, glm::dvec2(9, 18));
    EXPECT_EQ(found[motion::index_of(Joint::kLeftWrist)].confidence, 0.75);
    EXPECT_EQ(found[motion::index_of(Joint::kPelvis)].pixel, glm::dvec2(11.5, 23)) << "between the hips";
    EXPECT_TRUE(test.detections.lacking[motion::index_of(Joint::kLeftHeel)]);
}

TEST(KeyPoints, RefuseWhatIsNoDetectors) {
    DetectionFolder test;
    expect_input_error([&] { test.read(); }, {"no key points"});
    const auto path = test.folder.path / "c00_f000.json";
    const auto refuses = [&](const std::string& text, std::initializer_list<std::string> parts) {
        write_text(path, text);
        expect_input_error([&] { test.read(); }, parts);
    };
    refuses("{}", {"c00_f000.json", "people"});
    refuses("{\"people\": 3}", {"c00_f000.json", "people"});
    refuses("{\"people\": [" + person(19, 1) + "]}", {"c00_f000.json", "people[0]", "19 key points", "COCO-17"});
    refuses("{\"people\": [{\"pose_keypoints_2d\": [1, 2]}]}", {"people[0].pose_keypoints_2d"});
    refuses("{\"people\": [{\"pose_keypoints_2d\": [1, 2, \"a\"]}]}", {"people[0].pose_keypoints_2d[2]"});
    refuses("{\"people\": [{\"pose_keypoints_2d\": [1e300, 2, 1]}]}", {"people[0].pose_keypoints_2d[0]", "pixel"});
    refuses("{\"people\": []}", {"no key points"});
    write_text(path, "{\"people\": [" + person(17, 1) + "]}");
    write_text(test.folder.path / "c00_f001.json", "{\"people\": [" + person(25, 1) + "]}");
    expect_input_error([&] { test.read(); }, {"c00_f001.json", "BODY_25", "COCO-17", "one detector"});
}

}  // namespace
}  // namespace neuvv

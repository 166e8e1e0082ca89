// Skeletons and key points that other programs wrote.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>

#include "motion/detector.h"
#include "motion/pose_line.h"
#include "motion/skeleton_file.h"
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

// Markers in TRC files, and lines of poses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/detector.h"
#include "motion/live/pose_line.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/input_error.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv::motion_files_test {
namespace {

using motion::Joint;

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
    EXPECT_NE(clip.notes[0].text.find("take.trc: the body stands along z"), std::string::npos) << clip.notes[0].text;
    motion::SkeletonReading lying;
    lying.up = motion::Axis::kY;
    test::expect_near(motion::at(motion::read_skeleton(path, lying).frames[0], Joint::kNeck).position, {0, 0, 1.4});
}

// Fields parted by spaces, or padded with them, and without a pelvis.
TEST(Trc, ReadsSpaces) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& name, const std::string& text) {
        write_text(folder.path / name, text);
        return motion::read_skeleton(folder.path / name).frames;
    };
    const std::string by_spaces =
        "PathFileType  4  (X/Y/Z)  C:\\my takes\\take.trc\nDataRate Units NumMarkers\n60  m 6\n"
        "Frame#  Time  RHip  LHip  RKnee RAnkle RShoulder LShoulder\n  X1 Y1 Z1\n\n"
        "1   0.0   -0.1 1 0   0.1 1 0  -0.1 0.55 0  -0.1 0.1 0  -0.2 1.4 0  0.2 1.4 0  \n"
        "2   0.01  -0.1 1 0   0.1 1 0  -0.1 nan nan  -0.1 0.1 0  -0.2 1.4 0  0.2 1.4 0\n";
    const std::string padded =
        "PathFileType\t4\t(X/Y/Z)\ttake.trc\r\nDataRate \t Units\r\n 60 \t m\r\n"
        "Frame#\tTime\tRHip \t\t\t LHip\t\t\tRKnee\t\t\tRAnkle\t\t\tRShoulder\t\t\tLShoulder\r\n\t\tX1\r\n"
        " 1\t 0.0\t-0.1\t 1\t0 \t0.1\t1\t0\t-0.1\t0.55\t0\t-0.1\t0.1\t0\t-0.2\t1.4\t0\t 0.2\t1.4\t0\r\n"
        "2\t0.01\t-0.1\t1\t0\t0.1\t1\t0\t-0.1\t  \t\t-0.1\t0.1\t0\t-0.2\t1.4\t0\t0.2\t1.4\t0\r\n";
    for (const auto& frames : {read("a.trc", by_spaces), read("b.trc", padded)}) {
        ASSERT_EQ(frames.size(), 2u);
        test::expect_near(motion::at(frames[0], Joint::kPelvis).position, {0, 1, 0});
        test::expect_near(motion::at(frames[0], Joint::kNeck).position, {0, 1.4, 0});
        test::expect_near(motion::at(frames[0], Joint::kRightKnee).position, {-0.1, 0.55, 0});
        EXPECT_EQ(motion::at(frames[1], Joint::kRightKnee).confidence, 0);
        test::expect_near(motion::at(frames[1], Joint::kLeftShoulder).position, {0.2, 1.4, 0});
    }
    // Pose2Sim's world is turned to that of its cameras: X, Y, Z are y, z, x there, which readers turn to x, z, −y.
    const auto turned = read("pose-3d/a.trc", by_spaces);
    test::expect_near(motion::at(turned[0], Joint::kRightKnee).position, {0, 0.55, 0.1});
}

TEST(Trc, OfPose2SimStands) {
    const std::filesystem::path data = NEUVV_SOURCE_DIR "/../shared/data/pose2sim/single/pose-3d";
    if (!std::filesystem::is_directory(data)) GTEST_SKIP() << "no ../shared/data/pose2sim";
    for (const auto& file : std::filesystem::directory_iterator(data)) {
        const motion::SkeletonClip clip = motion::read_skeleton(file.path());
        ASSERT_EQ(clip.notes.size(), 1u);
        EXPECT_NE(clip.notes[0].text.find("turned to how its cameras stand"), std::string::npos) << clip.notes[0].text;
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

}  // namespace
}  // namespace neuvv::motion_files_test

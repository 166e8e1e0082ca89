// Key points that detectors wrote.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "support/input_error.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv::motion_files_test {
namespace {

using motion::Joint;

// Joints in a row, but with pelvis and neck where a body has them, by which BODY_25 is told.
motion::KeyPoints some_points(double shift) {
    motion::KeyPoints points;
    for (size_t j = 0; j < motion::kJoints; ++j) points[j] = {{10.5 * double(j) + shift, 7}, 0.5};
    const auto set_between = [&](Joint middle, Joint right, Joint left) {
        points[motion::index_of(middle)].pixel =
            0.5 * (points[motion::index_of(right)].pixel + points[motion::index_of(left)].pixel);
    };
    set_between(Joint::kPelvis, Joint::kRightHip, Joint::kLeftHip);
    set_between(Joint::kNeck, Joint::kRightShoulder, Joint::kLeftShoulder);
    points[motion::index_of(Joint::kNose)].pixel.y = 60;
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
    const auto shift_of = [&](size_t frame) { return test.detections.in(frame, 1)[2].pixel.x - 21; };
    EXPECT_EQ(shift_of(2), '2');
    // Names are in the order of their numbers.
    for (const char* name : {"000001", "000002"})
        std::filesystem::remove(test.folder.path / "c01_json" / (std::string(name) + ".json"));
    motion::write_key_points(test.folder.path / "c01_json" / "f9.json", some_points('9'));
    motion::write_key_points(test.folder.path / "c01_json" / "f10.json", some_points('1'));
    test.read();
    EXPECT_EQ(shift_of(1), '9');
    EXPECT_EQ(shift_of(2), '1');
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

std::string person(size_t points, double confidence) {
    std::string list;
    for (size_t i = 0; i < points; ++i) list += fmt::format("{}{}, {}, {}", i ? ", " : "", i, 2 * i, confidence);
    return "{\"pose_keypoints_2d\": [" + list + "]}";
}

// A set of a person who stands; each joint in its place and all other key points far away.
std::string standing(const motion::KeyPointLayout& layout) {
    const motion::Pose pose = test::performer_motion(1).frames[0];
    std::vector<glm::dvec2> places(layout.points, glm::dvec2(900, 900));
    for (size_t j = 0; j < motion::kJoints; ++j)
        for (const int source : layout.sources[j])
            if (source >= 0 && layout.sources[j][0] == layout.sources[j][1])
                places[size_t(source)] = {300 * pose[j].position.x, -300 * pose[j].position.y};
    std::string list;
    for (const glm::dvec2& place : places)
        list += fmt::format("{}{}, {}, 0.5", list.empty() ? "" : ", ", place.x, place.y);
    return "{\"people\": [{\"pose_keypoints_2d\": [" + list + "]}]}";
}

// The orders that their authors publish; Pose2Sim's skeletons.py has them all.
TEST(KeyPoints, OfEachSetAreInTheirAuthorsOrder) {
    struct Published {
        const char* name;
        size_t points;
        std::array<int, 6> right_left;  // right shoulder, left wrist, right hip, left ankle, right big toe, left heel
    };
    constexpr Published kPublished[] = {
        {"COCO_17", 17, {6, 9, 12, 15, -1, -1}},        {"BODY_25", 25, {2, 7, 9, 14, 22, 21}},
        {"BODY_25B", 25, {6, 9, 12, 15, 22, 21}},       {"HALPE_26", 26, {6, 9, 12, 15, 21, 24}},
        {"HALPE_68", 68, {6, 9, 12, 15, 21, 24}},       {"HALPE_136", 136, {6, 9, 12, 15, 21, 24}},
        {"COCO_133", 133, {6, 9, 12, 15, 20, 19}},      {"COCO-WholeBody", 133, {6, 9, 12, 15, 20, 19}},
        {"BODY_135", 135, {6, 9, 12, 15, 22, 21}},      {"BLAZEPOSE", 33, {12, 15, 24, 27, 32, 29}},
        {"MediaPipe-33", 33, {12, 15, 24, 27, 32, 29}}, {"COCO", 18, {2, 7, 8, 13, -1, -1}}};
    constexpr Joint kOrder[] = {Joint::kRightShoulder, Joint::kLeftWrist,   Joint::kRightHip,
                                Joint::kLeftAnkle,     Joint::kRightBigToe, Joint::kLeftHeel};
    for (const auto& [name, points, numbers] : kPublished) {
        const motion::KeyPointLayout* layout = motion::find_key_point_layout(std::string_view(name));
        ASSERT_NE(layout, nullptr) << name;
        EXPECT_EQ(layout->points, points) << name;
        for (size_t i = 0; i < numbers.size(); ++i)
            EXPECT_EQ(layout->sources[motion::index_of(kOrder[i])][0], numbers[i]) << name << i;
    }
    EXPECT_EQ(motion::find_key_point_layout(std::string_view("COCO-18")), nullptr);
    EXPECT_EQ(motion::find_key_point_layout(std::string_view("")), nullptr);
}

TEST(KeyPoints, OfTwoSetsOfOneSizeAreToldOrMustBeNamed) {
    DetectionFolder test;
    const auto read_knee = [&](const motion::KeyPointLayout* named) {
        motion::read_detections(test.folder.path, test.images, test.detections, named);
        return test.detections.in(0, 0)[motion::index_of(Joint::kRightKnee)].pixel;
    };
    const auto path = test.folder.path / "c00_f000.json";
    const motion::KeyPointLayout* const body_25 = motion::find_key_point_layout(25);
    const motion::KeyPointLayout* const body_25b = motion::find_key_point_layout(std::string_view("BODY_25B"));
    write_text(path, standing(*body_25));
    const glm::dvec2 knee = read_knee(body_25);
    EXPECT_EQ(read_knee(nullptr), knee);
    EXPECT_NE(read_knee(body_25b), knee);
    // All in one place: both would do.
    write_text(path, "{\"people\": [" + person(25, 1) + "]}");
    expect_input_error([&] { read_knee(nullptr); }, {"25 key points", "BODY_25 or BODY_25B", "name the set"});
    EXPECT_EQ(read_knee(body_25b), glm::dvec2(14, 28));
    const motion::ImagePeople of_other_sets[] = {{"a", {std::vector<motion::KeyPoint>(25)}},
                                                 {"b", {std::vector<motion::KeyPoint>(17, {{1, 2}, 1})}}};
    EXPECT_EQ(motion::layout_of(of_other_sets), nullptr);
    expect_input_error([&] { read_knee(motion::find_key_point_layout(26)); },
                       {"c00_f000.json", "25 key points", "26 of HALPE-26"});
}

TEST(KeyPoints, OfImagesWithOneNameNeedFolders) {
    DetectionFolder test;
    for (motion::WantedImage& image : test.images) image.image = "0001";
    motion::write_key_points(test.folder.path / "0001.json", some_points(0));
    expect_input_error([&] { test.read(); }, {"several cameras", "0001", "folder for each camera"});
}

TEST(KeyPoints, OfTheMostConfidentPersonCount) {
    DetectionFolder test;
    const auto path = test.folder.path / "c00_f000.json";
    write_text(path, "{\"people\": [" + person(17, 0.25) + "," + person(17, 0.75) + "," + person(17, 0.5) + "]}");
    test.read();
    EXPECT_EQ(test.detections.people[0].size(), 3u);
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
}  // namespace neuvv::motion_files_test

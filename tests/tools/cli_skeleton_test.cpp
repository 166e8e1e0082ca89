// neuvv skeleton: from the images of a rig to a skeleton file, and from other programs' files.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "motion/colour_model.h"
#include "motion/detector.h"
#include "motion/live/pose_line.h"
#include "motion/senders.h"
#include "motion/skeleton/median.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/trainee.h"
#include "motion/video/triangulate.h"
#include "support/child_process.h"
#include "tests/tools/run_neuvv.h"
#include "training/capture/capture_files.h"

namespace neuvv {
namespace {

constexpr size_t kFrames = 12, kMarkedFrames = 3, kViews = 12;

// Of COCO-17, those that are a single key point each.
constexpr std::array kSeenJoints = {
    motion::Joint::kNose,         motion::Joint::kRightShoulder, motion::Joint::kRightElbow, motion::Joint::kRightWrist,
    motion::Joint::kLeftShoulder, motion::Joint::kLeftElbow,     motion::Joint::kLeftWrist,  motion::Joint::kRightHip,
    motion::Joint::kRightKnee,    motion::Joint::kRightAnkle,    motion::Joint::kLeftHip,    motion::Joint::kLeftKnee,
    motion::Joint::kLeftAnkle};

struct CliSkeleton : testing::Test {
    TemporaryFolder folder;
    motion::SkeletonClip truth = test::performer_motion(kFrames);

    std::string file(const std::string& name) const { return (folder.path / name).string(); }

    // Writes what `neuvv skeleton views` and a detector leave, but for what the images show.
    void write_views() const {
        const std::vector<stage::Camera> cameras = test::cameras_around(truth, kViews);
        motion::Detections seen = test::detect(truth, cameras, {}, 5);
        std::filesystem::create_directories(folder.path / "views" / "images");
        std::filesystem::create_directories(folder.path / "views" / "key_points");
        for (size_t c = 0; c < kViews; ++c)
            for (size_t f = 0; f < kFrames; ++f) {
                const std::string name = training::image_name(c, f);
                media::write_png(folder.path / "views" / "images" / (name + ".png"), media::Image(1, 1));
                motion::write_key_points(folder.path / "views" / "key_points" / (name + "_keypoints.json"),
                                         seen.in(f, c));
            }
        training::write_transforms(folder.path / "views" / "transforms_train.json",
                                   {cameras, std::vector<bool>(kViews, true), kFrames, 25, {{-1, 0, -1}, {1, 2, 1}}});
    }

    // What `neuvv skeleton views` leaves, but of a performer whose joints alone are seen, three frames from 12 views.
    void write_marked_views() {
        truth.frames.resize(kMarkedFrames);
        const motion::KeyPointLayout& layout = *motion::find_key_point_layout(17);
        const std::vector<stage::Camera> cameras = test::cameras_around(truth, kViews);
        std::filesystem::create_directories(folder.path / "views" / "images");
        for (size_t c = 0; c < kViews; ++c)
            for (size_t f = 0; f < kMarkedFrames; ++f) {
                media::Image image = test::grey_image(cameras[c].width, cameras[c].height);
                for (const motion::Joint joint : kSeenJoints)
                    test::draw_marker(image, static_cast<size_t>(layout.sources[motion::index_of(joint)][0]), 17,
                                      *motion::project(cameras[c], motion::at(truth.frames[f], joint).position), 3);
                media::write_png(folder.path / "views" / "images" / (training::image_name(c, f) + ".png"), image);
            }
        training::write_transforms(
            folder.path / "views" / "transforms_train.json",
            {cameras, std::vector<bool>(kViews, true), kMarkedFrames, 25, {{-1, 0, -1}, {1, 2, 1}}});
    }
};

TEST_F(CliSkeleton, ExtractsFromViews) {
    write_views();
    const ProgramResult result = run_neuvv({"skeleton", "extract", file("views"), "-o", file("a.skeleton.glb")});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("left_wrist"), std::string::npos);
    EXPECT_NE(result.out.find("were exchanged back"), std::string::npos);
    const motion::SkeletonClip found = motion::read_skeleton(file("a.skeleton.glb"));
    EXPECT_DOUBLE_EQ(found.fps, 25);
    ASSERT_EQ(found.frames.size(), kFrames);
    EXPECT_LT(test::error_of(found, truth).mean, 0.02);
    EXPECT_EQ(test::error_of(found, truth).swapped_frames, 0u);

    expect_refused({"skeleton", "extract", file("views"), "--key-points", file("none"), "-o", file("b.glb")}, 2,
                   {"none", "no folder of key points"});
    expect_refused({"skeleton", "extract", file("none"), "-o", file("b.glb")}, 2, {"none"});
    EXPECT_FALSE(std::filesystem::exists(file("b.glb")));
}

// The distances of joints, millimetres: all that both know but pelvis and neck, which markers do not have or mean
// otherwise.
std::vector<double> distances_mm(const motion::SkeletonClip& a, const motion::SkeletonClip& b) {
    std::vector<double> distances;
    for (size_t f = 0; f < std::min(a.frames.size(), b.frames.size()); ++f)
        for (size_t j = 2; j < motion::kJoints; ++j)
            if (a.frames[f][j].confidence > 0 && b.frames[f][j].confidence > 0)
                distances.push_back(1000 * glm::distance(a.frames[f][j].position, b.frames[f][j].position));
    return distances;
}

double median_mm(const motion::SkeletonClip& a, const motion::SkeletonClip& b) {
    std::vector<double> distances = distances_mm(a, b);
    EXPECT_GT(distances.size(), 1800u);
    return motion::median(distances);
}

// Real cameras and a real detector, against what Pose2Sim made of them: its raw .trc triangulates each frame by itself,
// and is about 6 mm off by noise alone, as its filtered one tells.
TEST_F(CliSkeleton, ExtractsPose2SimsDemo) {
    const std::filesystem::path data = NEUVV_SOURCE_DIR "/../shared/data/pose2sim";
    if (!std::filesystem::is_directory(data)) GTEST_SKIP() << "no ../shared/data/pose2sim";
    const auto extract = [&](const std::string& trial, const std::string& person, bool each_frame) {
        std::vector<std::string> arguments = {
            "skeleton", "extract", (data / trial).string(), "-o", file("a.skeleton.glb"), "--overwrite",
            "--person", person};
        if (each_frame) arguments.emplace_back("--each-frame");
        const ProgramResult result = run_neuvv(arguments);
        EXPECT_EQ(result.code, 0) << result.err;
        return motion::read_skeleton(file("a.skeleton.glb"));
    };
    struct Trial {
        const char *trial, *person, *trc;
    };
    constexpr Trial kTrials[] = {{"single", "1", "S00_P00_T01_BalancingTrial_0-100"},
                                 {"multi", "2", "S00_P01_T02_Participants1-2_P2_0-100"}};
    for (const Trial& one : kTrials) {
        const auto reference = [&](const char* ending) {
            return motion::read_skeleton(data / one.trial / "pose-3d" / (std::string(one.trc) + ending));
        };
        const motion::SkeletonClip raw = reference(".trc"), filtered = reference("_filt_butterworth.trc");
        const motion::SkeletonClip fitted = extract(one.trial, one.person, false);
        const motion::SkeletonClip each = extract(one.trial, one.person, true);
        std::printf("%s: %.2f mm from the raw .trc, %.2f from the filtered; without the fit %.2f and %.2f\n", one.trial,
                    median_mm(fitted, raw), median_mm(fitted, filtered), median_mm(each, raw),
                    median_mm(each, filtered));
        EXPECT_LT(median_mm(fitted, raw), 8);
        EXPECT_LT(median_mm(each, raw), 4);
        EXPECT_LT(median_mm(fitted, filtered), median_mm(each, filtered));
        EXPECT_NEAR(motion::body_height(motion::bone_lengths(fitted)), 1.7, 0.1);
    }
    // The other one sits, and its key points agree less: cameras are off by more than 3 % of so small a body.
    const motion::SkeletonClip other =
        motion::read_skeleton(data / "multi" / "pose-3d" / "S00_P01_T02_Participants1-2_P1_0-100.trc");
    EXPECT_LT(median_mm(extract("multi", "1", false), other), 25);
    expect_refused({"skeleton", "extract", (data / "multi").string(), "-o", file("b.glb"), "--person", "4"}, 2,
                   {"--person", "4", "3 were found"});
    expect_refused({"skeleton", "extract", (data / "multi").string(), "-o", file("b.glb"), "--set", "BODY_26"}, 2,
                   {"--set", "BODY_26", "BODY_25B"});
    expect_refused({"skeleton", "extract", (data / "multi").string(), "-o", file("b.glb"), "--set", "COCO_17"}, 2,
                   {"cam01", "25 key points", "17 of COCO-17"});
}

// Key points by a network: it finds markers that are drawn where COCO's key points are.
TEST_F(CliSkeleton, ExtractsWithANetwork) {
    write_marked_views();
    write_text(folder.path / "colours.onnx", test::onnx_of({.scale = motion::PixelScale::kBytes}));
    std::vector<std::string> words = {
        "skeleton",           "extract",  file("views"), "-o", file("a.skeleton.glb"), "--model",
        file("colours.onnx"), "--pixels", "bytes"};
    const ProgramResult result = run_neuvv(words);
    ASSERT_EQ(result.code, 0) << result.err;
    words.emplace_back("--overwrite");
    EXPECT_NE(result.err.find("wrote COCO-17 key points of 36 images"), std::string::npos) << result.err;
    EXPECT_NE(result.out.find("(the detector lacks it)"), std::string::npos) << result.out;
    const motion::SkeletonClip found = motion::read_skeleton(file("a.skeleton.glb"));
    for (size_t f = 0; f < found.frames.size(); ++f)
        for (const motion::Joint joint : kSeenJoints)
            EXPECT_LT(
                glm::distance(motion::at(found.frames[f], joint).position, motion::at(truth.frames[f], joint).position),
                0.03)
                << f << ' ' << motion::info_of(joint).name;
    // The files that it wrote give the same skeleton again.
    ASSERT_EQ(run_neuvv({"skeleton", "extract", file("views"), "-o", file("b.skeleton.glb")}).code, 0);
    EXPECT_EQ(read_text(file("a.skeleton.glb")), read_text(file("b.skeleton.glb")));

    expect_refused(words, 2, {"key_points", "is there already", "--model"});
    std::filesystem::remove_all(folder.path / "views" / "key_points");
    write_text(folder.path / "colours.onnx", test::onnx_of({.first_operation = "Conjure"}));
    expect_refused(words, 2, {"colours.onnx", "cannot be opened"});
    write_text(folder.path / "colours.onnx", test::onnx_of({.key_points = 20}));
    expect_refused(words, 2, {"colours.onnx", "20 key points"});
    words[6] = file("none.onnx");
    expect_refused(words, 2, {"none.onnx"});
    expect_refused({"skeleton", "extract", file("views"), "-o", file("b.glb"), "--pixels", "unit"}, 2, {"--model"});
}

TEST_F(CliSkeleton, ImportsAModelsMotion) {
    const std::string model = NEUVV_SOURCE_DIR "/tools/performer/performer.glb";
    const ProgramResult result = run_neuvv({"skeleton", "import", model, "-o", file("a.skeleton.glb")});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("21 of 21 joints are measured"), std::string::npos) << result.out;
    const motion::SkeletonClip found = motion::read_skeleton(file("a.skeleton.glb"));
    for (size_t f = 0; f < kFrames; ++f)
        for (size_t j = 0; j < motion::kJoints; ++j)
            EXPECT_LT(glm::distance(found.frames[f][j].position, truth.frames[f][j].position), 1e-4);
    ASSERT_EQ(run_neuvv({"skeleton", "export", file("a.skeleton.glb"), "-o", file("a.bvh"), "--unit", "cm"}).code, 0);
    ASSERT_EQ(run_neuvv({"skeleton", "import", file("a.bvh"), "-o", file("b.skeleton.glb")}).code, 0);
    const motion::SkeletonClip back = motion::read_skeleton(file("b.skeleton.glb"));
    EXPECT_LT(glm::distance(motion::at(back.frames[9], motion::Joint::kLeftBigToe).position,
                            motion::at(truth.frames[9], motion::Joint::kLeftBigToe).position),
              1e-4);
    expect_refused({"skeleton", "export", file("a.skeleton.glb"), "-o", file("a.fbx")}, 2, {"a.fbx", ".bvh"});
    expect_refused({"skeleton", "import", file("none.bvh"), "-o", file("b.glb")}, 2, {"none.bvh"});
    expect_refused({"skeleton"}, 2, {"neuvv skeleton --help"});
}

TEST_F(CliSkeleton, ComparesATraineeWithATrainer) {
    truth = test::performer_motion(75);
    motion::write_skeleton(file("trainer.skeleton.glb"), truth);
    const auto trainee = test::with_arm_off(truth, motion::Limb::kLeftArm, 25, 1, 2);
    motion::write_skeleton(file("<b>trainee.glb"), test::other_body(trainee, 0.9, {1, 0, 2}, 1));
    const std::vector<std::string> compare = {"skeleton", "compare", file("trainer.skeleton.glb"),
                                              file("<b>trainee.glb")};
    const auto run = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = compare;
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult result = run_neuvv(words);
        EXPECT_EQ(result.code, 0) << result.err;
        return result.out;
    };
    EXPECT_NE(run({"--html", file("r.html"), "--csv", file("r.csv")}).find("left arm: 25° off from 1.0 s to 2.0 s"),
              std::string::npos);
    const nlohmann::json json = nlohmann::json::parse(run({"--json"}));
    EXPECT_GT(json["score"], 95);
    EXPECT_EQ(json["limbs"]["head"], 100);
    ASSERT_EQ(json["mistakes"].size(), 1u);
    EXPECT_EQ(json["mistakes"][0]["limb"], "left arm");
    EXPECT_NEAR(json["mistakes"][0]["degrees"], 25, 1);
    EXPECT_EQ(nlohmann::json::parse(run({"--json", "--leave-out", "left arm"}))["score"], 100);

    const std::string html = read_text(file("r.html"));
    EXPECT_EQ(html.find("<!DOCTYPE html>"), 0u);
    EXPECT_NE(html.find("&lt;b&gt;trainee.glb"), std::string::npos);
    EXPECT_EQ(html.find("<b>"), std::string::npos) << "names are escaped";
    EXPECT_NE(html.find("left arm: 25° off"), std::string::npos);
    EXPECT_EQ(html.find("nan"), std::string::npos);
    const std::string csv = read_text(file("r.csv"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 76);
    EXPECT_EQ(csv.find("time_s,trainer_time_s,score,trunk_deg,head_deg,right_arm_deg"), 0u);

    expect_refused({"skeleton", "compare", file("trainer.skeleton.glb"), file("none.bvh")}, 2, {"none.bvh"});
    expect_refused({"skeleton", "compare", compare[2], compare[3], "--leave-out", "tail"}, 2, {"tail", "left leg"});
}

TEST_F(CliSkeleton, FollowsAStreamOfPoses) {
    truth = test::performer_motion(75);
    motion::write_skeleton(file("trainer.skeleton.glb"), truth);
    const auto trainee =
        test::other_body(test::with_arm_off(truth, motion::Limb::kLeftArm, 30, 1, 2), 0.9, {1, 0, 2}, 1);
    std::string lines = "this is no pose" + std::string(200000, '!') + "\n";
    for (size_t f = 0; f < trainee.frames.size(); ++f)
        lines += motion::pose_line({100 + static_cast<double>(f) / 25, trainee.frames[f]}) + "\n";
    write_text(folder.path / "take.jsonl", lines + "{\"time\": 103, \"joints\": {\"tail\": [0, 0, 0]}}\n");
    const ProgramResult result = run_neuvv({"skeleton", "follow", file("trainer.skeleton.glb"), file("take.jsonl")});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("left arm: 30° off"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("left arm: right again"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("score 9"), std::string::npos) << result.out;
    EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 3) << result.out;
    EXPECT_NE(result.err.find("line 1"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("2 lines were left out"), std::string::npos) << result.err;
    expect_refused({"skeleton", "follow", file("trainer.skeleton.glb"), file("none.jsonl")}, 2, {"none.jsonl"});
    expect_refused({"skeleton", "follow", file("trainer.skeleton.glb")}, 2, {"stdin", "no pose"});
}

// Runs `neuvv skeleton follow` on a stream until something was left out of it, then interrupts it.
struct CliFollow : CliSkeleton {
    CliFollow() {
        truth = test::performer_motion(75);
        motion::write_skeleton(file("trainer.skeleton.glb"), truth);
    }

    std::string log() const { return read_text(folder.path / "log"); }

    void follow(const std::string& stream, const std::function<void(const std::string&)>& send) const {
        test::ChildProcess neuvv({NEUVV_PROGRAM, "skeleton", "follow", file("trainer.skeleton.glb"), stream},
                                 folder.path / "log");
        // A stream of lines needs no port, so its sender does not wait for one.
        const bool port = stream.find(':') != std::string::npos;
        ASSERT_TRUE(neuvv.until([&] { return !port || log().find('\n') != std::string::npos; })) << log();
        send(motion::pose_line({1, truth.frames[0]}) + "\n");
        send("no pose\n");
        ASSERT_TRUE(neuvv.until([&] { return log().find("left out") != std::string::npos; })) << log();
        neuvv.send(SIGINT);
        EXPECT_EQ(neuvv.wait(), 0) << log();
        EXPECT_NE(log().find("no score: the poses are too few"), std::string::npos) << log();
    }
};

TEST_F(CliFollow, APortUntilItIsInterrupted) {
    const test::UdpTransmitter transmitter;
    follow("udp:0", [&](const std::string& line) {
        const std::string name = "JSON on 127.0.0.1:", said = log();
        ASSERT_NE(said.find(name), std::string::npos) << said;
        transmitter.send(line, static_cast<uint16_t>(std::stoul(said.substr(said.find(name) + name.size()))));
    });
    expect_refused({"skeleton", "follow", file("trainer.skeleton.glb"), "vmc:none"}, 2, {"vmc:none", "no port"});
}

TEST_F(CliFollow, APipeUntilItIsInterrupted) {
    ASSERT_EQ(mkfifo(file("pipe").c_str(), 0600), 0);
    const int pipe = open(file("pipe").c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_GE(pipe, 0);
    follow(file("pipe"), [&](const std::string& line) {
        EXPECT_EQ(write(pipe, line.data(), line.size()), static_cast<ssize_t>(line.size()));
    });
    close(pipe);
}

}  // namespace
}  // namespace neuvv

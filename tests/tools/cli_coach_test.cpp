// neuvv coach: a trainee against the performer of a stage, on the command line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "media/image.h"
#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/trainee.h"
#include "support/body_tree.h"
#include "support/stage_on_disk.h"
#include "tests/tools/cli_gpu.h"

namespace neuvv {
namespace {

using motion::Limb;

constexpr float kCoachFps = 10;
constexpr uint32_t kStageImages = 30;  // three seconds

// Live poses are compared where at most two of the trainer's frames lie between them, so all rates are those of the
// images here.
motion::SkeletonClip at_rate(const motion::SkeletonClip& clip, double fps) {
    motion::SkeletonClip result{fps, {}};
    for (uint32_t i = 0; i < kStageImages; ++i) result.frames.push_back(motion::pose_at(clip, i * clip.fps / fps));
    return result;
}

// A stage with a dancer whose skeleton lies beside the .nvv, and a trainee whose left arm is off in the second second.
struct CliCoach : CliGpu {
    std::string show = file("show.gltf");
    motion::SkeletonClip dancer = at_rate(test::performer_motion(75), kCoachFps);

    void SetUp() override {
        tree = test::body_tree(dancer, kStageImages, kCoachFps);
        voctree::write_nvv(scene, tree);
        motion::write_skeleton(file("scene.skeleton.glb"), dancer);
        motion::write_skeleton(file("trainee.skeleton.glb"), trainee());
        test::write_stage(show, scene, "anna");
        const ProgramResult set = run_neuvv({"stage", "set", show, "--fps", std::to_string(kCoachFps)});
        ASSERT_EQ(set.code, 0) << set.err;
    }
    motion::SkeletonClip trainee() const {
        return test::other_body(test::with_arm_off(dancer, Limb::kLeftArm, 40, 1, 2), 0.9, {1, 0, 2}, 1);
    }
    std::vector<std::string> words(const std::string& images, const std::vector<std::string>& more) const {
        std::vector<std::string> all = {"coach", "--overwrite", show, "-o", file((images + "_%03d.png").c_str())};
        const auto add_default = [&](const char* option, const std::string& value) {
            if (std::ranges::find(more, option) == more.end()) all.insert(all.end(), {option, value});
        };
        add_default("--size", "96x72");
        add_default("--against", file("trainee.skeleton.glb"));
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    // Returns what the program prints.
    std::string coach(const std::string& images, const std::vector<std::string>& more = {}) const {
        const ProgramResult result = run_neuvv(words(images, more));
        EXPECT_EQ(result.code, 0) << result.err;
        return result.out;
    }
    std::string image_file(const std::string& images, size_t index) const {
        return file(fmt::format("{}_{:03}.png", images, index).c_str());
    }
    size_t count(const std::string& images) const {
        size_t found = 0;
        while (std::filesystem::exists(image_file(images, found))) ++found;
        return found;
    }
};

double redness(const media::Image& image, uint32_t x, uint32_t y) {
    const uint8_t* pixel = image.at(x, y);
    return pixel[0] - 0.5 * (pixel[1] + pixel[2]);
}

// Pixels that are redder in `red` than in `plain`, below the words at the top.
size_t redder(const media::Image& red, const media::Image& plain) {
    size_t found = 0;
    for (uint32_t y = 44; y < red.height; ++y)
        for (uint32_t x = 0; x < red.width; ++x) found += redness(red, x, y) > redness(plain, x, y) + 30;
    return found;
}

TEST_F(CliCoach, AMistakeIsRedAndNamed) {
    const std::vector<std::string> still = {"--camera", "camera", "--no-ghost", "--no-arrows", "--size", "192x144"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), still.begin(), still.end());
        return more;
    };
    const std::string out = coach("red", with({"--html", file("report.html")}));
    EXPECT_NE(out.find("left arm: "), std::string::npos) << out;
    EXPECT_NE(out.find("° off from "), std::string::npos) << out;
    EXPECT_NE(out.find("30 images"), std::string::npos) << out;
    const std::string html = read_text(file("report.html"));
    EXPECT_EQ(html.find("<!DOCTYPE html>"), 0u);
    EXPECT_NE(html.find("left arm: "), std::string::npos);
    const std::string watched = coach("plain", with({"--mode", "watch"}));
    EXPECT_EQ(watched.find("left arm"), std::string::npos) << watched;
    ASSERT_EQ(count("red"), kStageImages);
    ASSERT_EQ(count("plain"), kStageImages);
    const auto redder_at = [&](size_t index) {
        return redder(media::read_png(image_file("red", index)), media::read_png(image_file("plain", index)));
    };
    EXPECT_EQ(redder_at(5), 0u) << "before the mistake";
    EXPECT_GT(redder_at(15), 20u) << "during the mistake";
    EXPECT_EQ(redder_at(28), 0u) << "after the mistake";
}

TEST_F(CliCoach, JsonAndLeftOutLimbs) {
    const nlohmann::json json = nlohmann::json::parse(coach("a", {"--json"}));
    EXPECT_LT(json["limbs"]["left arm"], 95);
    EXPECT_EQ(json["limbs"]["left leg"], 100);
    ASSERT_EQ(json["mistakes"].size(), 1u);
    EXPECT_EQ(json["mistakes"][0]["limb"], "left arm");
    EXPECT_NEAR(json["mistakes"][0]["degrees"], 40, 5);
    EXPECT_NEAR(json["mistakes"][0]["from_s"], 1, 0.2);
    const std::string without = coach("b", {"--json", "--leave-out", "left arm"});
    EXPECT_TRUE(nlohmann::json::parse(without)["mistakes"].empty()) << without;
}

TEST_F(CliCoach, TheCameraFliesUnlessTheStagesIsNamed) {
    coach("own");
    coach("stage", {"--camera", "camera"});
    const media::Image first = media::read_png(image_file("stage", 0));
    EXPECT_NE(media::read_png(image_file("own", 0)).rgba, first.rgba);
    const ProgramResult plain = run_neuvv({"render", "--overwrite", show, "-o", file("still.png"), "--size", "96x72",
                                           "--camera", "camera", "--time", "2.9"});
    ASSERT_EQ(plain.code, 0) << plain.err;
    coach("bare", {"--camera", "camera", "--mode", "watch"});
    EXPECT_EQ(media::read_png(image_file("bare", 29)).rgba, media::read_png(file("still.png")).rgba)
        << "what `neuvv render` shows";
}

TEST_F(CliCoach, TheClipWaitsForATraineeWhoDoesNotKeepUp) {
    coach("follow", {"--mode", "follow"});
    EXPECT_GT(count("follow"), kStageImages + 5);
    // Somebody who only stands there, for far longer than six times the stage.
    motion::SkeletonClip standing = dancer;
    standing.frames.assign(10 * 40, test::with_arm_off(dancer, Limb::kLeftArm, 80, 0, 3).frames[0]);
    motion::write_skeleton(file("standing.skeleton.glb"), standing);
    coach("stands", {"--mode", "follow", "--against", file("standing.skeleton.glb"), "--size", "32x24"});
    EXPECT_GT(count("stands"), 2 * kStageImages);
    EXPECT_LE(count("stands"), 6 * kStageImages);
    motion::write_skeleton(file("same.skeleton.glb"), dancer);
    coach("same", {"--mode", "follow", "--against", file("same.skeleton.glb"), "--size", "32x24"});
    EXPECT_EQ(count("same"), kStageImages) << "nothing to wait for";
}

TEST_F(CliCoach, TheStagesSkeletonComesBeforeTheOneBesideTheClip) {
    EXPECT_EQ(run_neuvv({"stage", "info", show}).out.find("trainee.skeleton.glb"), std::string::npos);
    const ProgramResult set = run_neuvv({"stage", "set", show, "anna", "--skeleton", file("trainee.skeleton.glb")});
    ASSERT_EQ(set.code, 0) << set.err;
    const std::string info = run_neuvv({"stage", "info", show}).out;
    EXPECT_NE(info.find("skeleton trainee.skeleton.glb"), std::string::npos) << info;
    const nlohmann::json json = nlohmann::json::parse(coach("a", {"--json"}));
    EXPECT_TRUE(json["mistakes"].empty()) << "the trainee against itself: " << json;
}

TEST_F(CliCoach, WhatCannotBeCoachedIsRefused) {
    const auto refused = [&](const std::vector<std::string>& more, const std::vector<std::string>& parts) {
        expect_refused(words("x", more), 2, parts);
    };
    refused({"--performer", "nobody"}, {"show.gltf", "nobody", "neuvv stage info"});
    refused({"--html", file("r.html"), "--mode", "follow"}, {"--html", "r.html"});
    refused({"--camera", "nobody"}, {"nobody", "camera"});
    refused({"--leave-out", "tail"}, {"tail", "left leg"});
    expect_refused({"coach", show, "--against", file("trainee.skeleton.glb"), "-o", file("x.png")}, 2,
                   {"x.png", "is one image", "out_%04d.png"});
    refused({"--against", file("none.bvh")}, {"none.bvh"});
    const std::string whole = read_text(file("trainee.skeleton.glb"));
    write_text(file("damaged.skeleton.glb"), whole.substr(0, whole.size() / 2));
    refused({"--against", file("damaged.skeleton.glb")}, {"damaged.skeleton.glb"});
    std::filesystem::remove(file("scene.skeleton.glb"));
    refused({}, {"show.gltf", "no performer with a skeleton", "neuvv skeleton"});
    refused({"--performer", "anna"}, {"anna", "scene.skeleton.glb"});
    EXPECT_EQ(count("x"), 0u);
    EXPECT_FALSE(std::filesystem::exists(file("r.html")));
}

}  // namespace
}  // namespace neuvv

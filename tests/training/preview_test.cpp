// How a run can be watched: by the preview image and the log of its numbers.
#include "training/run/preview.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/evaluation/evaluate.h"
#include "training/run/metrics_log.h"

namespace neuvv::test {
namespace {

using PreviewTest = GpuTest;

TEST_F(PreviewTest, ShowsTruthRenderAndErrorSideBySide) {
    const TemporaryFolder folder;
    const training::Dataset dataset =
        training::preview_dataset(sphere_dataset({.cameras = 3, .frames = 5, .size = 40}));
    const voctree::VOctree tree = random_tree({.leaves = 100, .frames = 5});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const training::Quality quality = training::write_preview(device(), field, dataset, folder.path / "preview.png");
    const media::Image image = media::read_png(folder.path / "preview.png");
    ASSERT_EQ(image.width, 120u);
    ASSERT_EQ(image.height, 40u);
    EXPECT_EQ(folder.entries(), 1u);
    const auto part = [&](uint32_t index) {
        media::Image column(40, 40);
        for (uint32_t y = 0; y < 40; ++y) std::copy_n(image.at(40 * index, y), 160, column.at(0, y));
        return column;
    };
    const media::Image truth = training::truth_over(dataset, dataset.views[0]);
    EXPECT_EQ(part(0).rgba, truth.rgba);
    EXPECT_EQ(part(2).rgba, training::error_image(truth, part(1)).rgba);
    EXPECT_EQ(training::compare(truth, part(1)).psnr, quality.psnr);
    const training::Evaluation evaluation = training::evaluate(
        device(), tree, dataset, {.samples = 2});  // of the same view, with weights in half precision
    EXPECT_NEAR(evaluation.views[0].psnr, quality.psnr, 0.1);
    EXPECT_LT(quality.psnr, 30) << "a random tree is no sphere";
}

TEST(PreviewDataset, IsTheFirstCamerasInstantInTheCentre) {
    training::Dataset dataset = sphere_dataset({.cameras = 3, .frames = 5, .size = 8});
    std::reverse(dataset.views.begin(), dataset.views.end());  // the first view is now that of the last camera
    const training::Dataset cut = training::preview_dataset(dataset);
    ASSERT_EQ(cut.views.size(), 1u);
    EXPECT_EQ(cut.views[0].name, "c02_f002");
    EXPECT_EQ(cut.views[0].time, 0.5);
    EXPECT_EQ(cut.views[0].camera, 0u);
    EXPECT_EQ(cut.cameras[0].world_from_camera, dataset.cameras[2].world_from_camera);
}

struct MetricsLogTest : ::testing::Test {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "metrics.jsonl";

    static training::TrainProgress at_step(uint64_t step) {
        training::TrainProgress now;
        now.step = step;
        now.loss = 0.25;
        now.grad_loss = 0.5;
        now.leaves = 42;
        return now;
    }
    std::vector<nlohmann::json> lines() const {
        std::vector<nlohmann::json> all;
        std::istringstream text(read_text(file));
        for (std::string line; std::getline(text, line);) all.push_back(nlohmann::json::parse(line));
        return all;
    }
};

TEST_F(MetricsLogTest, ALineAnInterval) {
    const training::MetricsLog log(file, 0);
    log.add(at_step(10));
    log.add(at_step(20), training::PreviewScore{"c01_f003", 31.5});
    ASSERT_EQ(lines().size(), 2u);
    EXPECT_EQ(lines()[0].at("step"), 10);
    EXPECT_EQ(lines()[0].at("loss"), 0.25);
    EXPECT_EQ(lines()[0].at("loss_grad"), 0.5);
    EXPECT_EQ(lines()[0].at("leaves"), 42);
    EXPECT_GT(lines()[0].at("memory_bytes"), 1000000);
    EXPECT_FALSE(lines()[0].contains("preview_psnr"));
    EXPECT_EQ(lines()[1].at("preview_psnr"), 31.5);
    EXPECT_EQ(lines()[1].at("preview_view"), "c01_f003");
}

TEST_F(MetricsLogTest, AResumedRunDropsWhatCameAfterItsCheckpoint) {
    {
        const training::MetricsLog log(file, 0);
        for (const uint64_t step : {10, 20, 30, 40}) log.add(at_step(step));
    }
    write_text(file, read_text(file) + "no JSON\n{\"step\":-3}\n[1]\n{\"step\":15}\n{\"step\":18");  // torn at the end
    const training::MetricsLog log(file, 30);
    log.add(at_step(31));
    std::vector<uint64_t> steps;
    for (const nlohmann::json& line : lines()) steps.push_back(line.at("step"));
    EXPECT_EQ(steps, (std::vector<uint64_t>{10, 20, 30, 15, 31}));
}

TEST_F(MetricsLogTest, ANewRunBeginsAnew) {
    training::MetricsLog(file, 0).add(at_step(10));
    training::MetricsLog(file, 0).add(at_step(5));
    ASSERT_EQ(lines().size(), 1u);
    EXPECT_EQ(lines()[0].at("step"), 5);
    training::MetricsLog(folder.path / "other.jsonl", 100).add(at_step(101));  // resumed, and logged for the first time
    EXPECT_NE(read_text(folder.path / "other.jsonl").find("101"), std::string::npos);
}

TEST_F(MetricsLogTest, ASegmentKeepsTheLinesOfOthers) {
    training::MetricsLog(file, 0, 0).add(at_step(10));
    training::MetricsLog(file, 0, 8).add(at_step(20));
    const training::MetricsLog again(file, 0, 0);  // the first segment is trained again
    again.add(at_step(3));
    ASSERT_EQ(lines().size(), 2u);
    EXPECT_EQ(lines()[0].at("first_frame"), 8);
    EXPECT_EQ(lines()[0].at("step"), 20);
    EXPECT_EQ(lines()[1].at("first_frame"), 0);
    training::MetricsLog(file, 25, 8).add(at_step(26));
    EXPECT_EQ(lines().size(), 3u) << "a segment that goes on keeps its own lines, too";
}

TEST_F(MetricsLogTest, NumbersThatAreNoneAreNull) {
    training::TrainProgress now = at_step(1);
    now.loss = NAN;
    training::MetricsLog(file, 0).add(now);
    EXPECT_TRUE(lines()[0].at("loss").is_null());
}

TEST_F(MetricsLogTest, AFileThatCannotBeWrittenIsAFailure) {
    EXPECT_THROW(training::MetricsLog(folder.path / "missing/metrics.jsonl", 0), RuntimeFailure);
    const training::MetricsLog log(file, 0);
    std::filesystem::remove(file);
    std::filesystem::create_directory(file);
    EXPECT_THROW(log.add(at_step(1)), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test

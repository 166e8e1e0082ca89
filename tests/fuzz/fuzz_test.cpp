// The fuzzer must see what it looks for.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "fuzz/mutate.h"
#include "fuzz/verdict.h"

namespace neuvv {
namespace {

TEST(Fuzz, OnlyAShortInputErrorIsAnAnswer) {
    const auto complaint_of = [](const auto& thrown) {
        return fuzz::complaint_about([&]() -> Dataset { throw thrown; });
    };
    EXPECT_EQ(complaint_of(InputError("file", "place", "is bad", "mend it")), "");
    EXPECT_EQ(complaint_of(InputError("file", std::string(5000, 'x'), std::string(5000, 'x'))), "") << "shortened";
    EXPECT_NE(complaint_of(std::out_of_range("at")), "");
    EXPECT_NE(complaint_of(RuntimeFailure("disk")), "");
    EXPECT_NE(complaint_of(7), "");
}

TEST(Fuzz, LoadedCamerasMustBeSound) {
    Dataset dataset;
    dataset.cameras.resize(1);
    dataset.cameras[0].width = dataset.cameras[0].height = 4;
    dataset.views.resize(1);
    const auto complaint = [&] { return fuzz::complaint_about([&] { return dataset; }); };
    EXPECT_EQ(complaint(), "");
    dataset.views[0].time = std::nan("");
    EXPECT_NE(complaint(), "");
    dataset.views[0].time = 1;
    dataset.cameras[0].cx = INFINITY;
    EXPECT_NE(complaint(), "");
    dataset.cameras[0].cx = 2;
    dataset.cameras[0].world_from_camera[3][1] = std::nan("");
    EXPECT_NE(complaint(), "");
}

TEST(Fuzz, LoadedStagesMustBeSound) {
    Stage stage;
    stage.file = make_stage_file("s.gltf", "{}");
    stage.clips.resize(1);
    stage.performers.resize(1);
    stage.scene.nodes.resize(1);
    stage.scene.order = {0};
    const auto complaint = [&] { return fuzz::complaint_about_stage([&] { return stage; }); };
    EXPECT_EQ(complaint(), "");
    stage.performers[0].settings.opacity = std::nan("");
    EXPECT_NE(complaint(), "");
    stage.performers[0].settings.opacity = 1;
    stage.performers[0].timeline.frames = 30;  // of a clip of one frame
    EXPECT_NE(complaint(), "");
    stage.performers.clear();
    stage.file.json["edited"] = true;
    EXPECT_NE(complaint(), "");
    EXPECT_NE(fuzz::complaint_about_stage([]() -> Stage { throw std::bad_alloc(); }), "");
}

TEST(Fuzz, ASeedFixesTheDamage) {
    const std::string whole = "K_01: [90.0, 0, 31.0]\nnames: [\"01\"]\n";
    const std::vector<std::string> others = {whole, "another file"};
    fuzz::Random a(5), b(5), c(6);
    std::set<std::string> distinct;
    bool differs = false;
    for (int i = 0; i < 1000; ++i) {
        const std::string damaged = fuzz::mutate(whole, others, 300, a);
        EXPECT_EQ(damaged, fuzz::mutate(whole, others, 300, b));
        EXPECT_LE(damaged.size(), 300u);
        differs |= damaged != fuzz::mutate(whole, others, 300, c);
        distinct.insert(damaged);
    }
    EXPECT_TRUE(differs);
    EXPECT_GT(distinct.size(), 900u);
}

}  // namespace
}  // namespace neuvv

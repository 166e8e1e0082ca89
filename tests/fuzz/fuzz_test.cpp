// Tests that the fuzzer finds the defects that it looks for.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>
#include <set>

#include "base/error.h"
#include "fuzz/mutate.h"
#include "fuzz/verdict.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/nvv.h"

namespace neuvv {
namespace {

TEST(Fuzz, OnlyAShortInputErrorIsAnAnswer) {
    const auto complaint_of = [](const auto& thrown) {
        return fuzz::complaint_about([&]() -> training::Dataset { throw thrown; });
    };
    EXPECT_EQ(complaint_of(InputError("file", "place", "is bad", "fix it")), "");
    EXPECT_EQ(complaint_of(InputError("file", std::string(5000, 'x'), std::string(5000, 'x'))), "") << "shortened";
    EXPECT_NE(complaint_of(std::out_of_range("at")), "");
    EXPECT_NE(complaint_of(RuntimeFailure("disk")), "");
    EXPECT_NE(complaint_of(7), "");
}

TEST(Fuzz, LoadedCamerasMustBeSound) {
    training::Dataset dataset;
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
    stage::Stage stage;
    stage.file = stage::make_stage_file("s.gltf", "{}");
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
    stage.file.json.set("edited", true);
    EXPECT_NE(complaint(), "");
    EXPECT_NE(fuzz::complaint_about_stage([]() -> stage::Stage { throw std::bad_alloc(); }), "");
}

TEST(Fuzz, LoadedClipsAndPaintMustBeSound) {
    const voctree::VOctree tree = test::random_tree({.leaves = 20});
    voctree::VOctree clip = tree;
    const auto of_clip = [&] { return fuzz::complaint_about_clip([&] { return clip; }); };
    EXPECT_EQ(of_clip(), "");
    clip.weights[5] = INFINITY;
    EXPECT_NE(of_clip(), "");
    clip = tree;
    ++clip.leaf_count;
    EXPECT_NE(of_clip(), "");
    EXPECT_EQ(fuzz::complaint_about_clip([]() -> voctree::VOctree { throw InputError("a", "b", "c"); }), "");
    voctree::EditLayer layer{voctree::painted_field(tree),
                             {{3, 0, 2, {1, 0, 0.5f}, 0.5f, voctree::kKeepSigma}, {4, 1, 1, {0, 0, 0}, 0, 9}}};
    const auto of_paint = [&] { return fuzz::complaint_about_paint([&] { return layer; }); };
    EXPECT_EQ(of_paint(), "");
    const std::vector<voctree::LeafEdit> sound = layer.edits;
    const auto expect_wrong = [&](const std::function<void(voctree::LeafEdit&)>& change) {
        layer.edits = sound;
        change(layer.edits[1]);
        EXPECT_NE(of_paint(), "");
    };
    expect_wrong([](voctree::LeafEdit& edit) { edit.leaf = 20; });
    expect_wrong([](voctree::LeafEdit& edit) { edit.last = 5; });
    expect_wrong([](voctree::LeafEdit& edit) { edit.first = -1; });
    expect_wrong([](voctree::LeafEdit& edit) { edit.colour.g = std::nanf(""); });
    expect_wrong([](voctree::LeafEdit& edit) { edit.alpha = 2; });
    expect_wrong([](voctree::LeafEdit& edit) { edit.sigma = -2; });
}

// Damage with valid checksums reaches the code that reads the content.
TEST(Fuzz, DamagedChunksKeepTheirChecksums) {
    const TemporaryFolder folder;
    const voctree::VOctree tree = test::random_tree({.leaves = 20});
    voctree::write_nvv(folder.path / "sound.nvv", tree);
    fuzz::Random random(3), again(3);
    size_t refused = 0, checksums = 0;
    for (int i = 0; i < 200; ++i) {
        const std::string bytes = fuzz::mutate_chunks(folder.path / "sound.nvv", {}, 4096, random);
        EXPECT_EQ(bytes, fuzz::mutate_chunks(folder.path / "sound.nvv", {}, 4096, again));
        write_text(folder.path / "damaged.nvv", bytes);
        try {
            voctree::read_nvv(folder.path / "damaged.nvv");
        } catch (const InputError& error) {
            ++refused;
            checksums += std::string(error.what()).find("checksum") != std::string::npos;
        }
    }
    EXPECT_GT(refused, 100u);
    EXPECT_LT(refused, 200u) << "other weights are weights, too";
    EXPECT_EQ(checksums, 0u);
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

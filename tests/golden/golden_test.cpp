// Whole images against the committed ones, and proof that the comparison notices wrong ones.
#include "golden/golden.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "golden/scenes.h"
#include "golden/set_scenes.h"
#include "golden/stage_scenes.h"
#include "support/gpu_test.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

using GoldenTest = GpuTest;

TEST_F(GoldenTest, ImagesAreAsAccepted) {
    const char* accept = std::getenv("NEUVV_ACCEPT_GOLDEN");
    bool known = !accept || std::string(accept) == "all";
    for (const GoldenScene& scene : golden_scenes()) {
        const std::string problem = check_golden(scene.name, render_scene(device(), scene));
        EXPECT_TRUE(problem.empty()) << scene.name << ": " << problem;
        known |= accept && scene.name == accept;
    }
    for (const GoldenSet& set : golden_sets()) {
        const std::string problem = check_golden(set.name, render_set(device(), set));
        EXPECT_TRUE(problem.empty()) << set.name << ": " << problem;
        known |= accept && set.name == accept;
    }
    for (const GoldenStage& stage : golden_stages(device(), accept && std::string(accept) != "all" ? accept : "")) {
        const std::string problem = check_golden(stage.name, stage.image);
        EXPECT_TRUE(problem.empty()) << stage.name << ": " << problem;
        known |= accept && stage.name == accept;
    }
    EXPECT_TRUE(known) << "no golden image has the name " << accept;
}

media::Image shifted(const media::Image& image, uint32_t pixels) {
    media::Image out = image;
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = pixels; x < image.width; ++x) std::copy_n(image.at(x - pixels, y), 4, out.at(x, y));
    return out;
}

media::Image swapped_red_and_blue(const media::Image& image) {
    media::Image out = image;
    for (size_t i = 0; i < out.rgba.size(); i += 4) std::swap(out.rgba[i], out.rgba[i + 2]);
    return out;
}

// The scene without the density of the leaves in one eighth of the box.
GoldenScene without_a_cluster(GoldenScene scene) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(scene.tree);
    for (uint32_t leaf = 0; leaf < scene.tree.leaf_count; ++leaf) {
        const uint32_t half = 1u << (positions[leaf].depth - 1);
        if (positions[leaf].x < half && positions[leaf].y < half && positions[leaf].z >= half)
            std::fill_n(scene.tree.leaf(leaf), scene.tree.bases, 0.0f);
    }
    return scene;
}

using GoldenComparison = GpuTest;

TEST_F(GoldenComparison, NoticesWrongImages) {
    for (const GoldenScene& scene : golden_scenes()) {
        SCOPED_TRACE(scene.name);
        const media::Image truth = render_scene(device(), scene);
        EXPECT_TRUE(compare_with_golden(truth, truth).passes());
        EXPECT_FALSE(compare_with_golden(shifted(truth, 2), truth).passes());
        if (scene.settings.resolve.show == render::Show::kColour) {
            EXPECT_FALSE(compare_with_golden(swapped_red_and_blue(truth), truth).passes());
        }
        EXPECT_FALSE(compare_with_golden(render_scene(device(), without_a_cluster(scene)), truth).passes());
        GoldenScene earlier = scene;
        earlier.settings.instances[0].frame -= 0.25f;
        EXPECT_FALSE(compare_with_golden(render_scene(device(), earlier), truth).passes());
        EXPECT_FALSE(compare_with_golden(media::Image(truth.width, truth.height - 1), truth).passes());
    }
}

TEST_F(GoldenComparison, NoticesWrongSets) {
    for (const GoldenSet& set : golden_sets()) {
        SCOPED_TRACE(set.name);
        const media::Image truth = render_set(device(), set);
        const auto passes = [&](const std::function<void(GoldenSet&)>& change) {
            GoldenSet other = set;
            change(other);
            return compare_with_golden(render_set(device(), other), truth).passes();
        };
        EXPECT_TRUE(passes([](GoldenSet&) {}));
        EXPECT_FALSE(passes([](GoldenSet& s) { s.lights[0].position.x -= 0.5; }));
        EXPECT_FALSE(passes([](GoldenSet& s) { s.ambient = {}; }));
        EXPECT_FALSE(passes([](GoldenSet& s) {
            for (stage::GltfMaterial& material : s.scene.materials) material.roughness = 1;
        }));
        if (set.volume_depth_m > 0) {
            EXPECT_FALSE(passes([](GoldenSet& s) { s.volume_depth_m = 1; })) << "all panes behind the volume";
        } else {
            EXPECT_FALSE(passes([](GoldenSet& s) { s.lights[0].casts_shadow = false; }));
        }
    }
}

TEST(GoldenTolerance, BearsRoundingButNoMissingAlpha) {
    media::Image truth(64, 64);
    for (size_t i = 0; i < truth.rgba.size(); ++i)
        truth.rgba[i] = static_cast<uint8_t>(i % 4 == 3 ? 128 : 40 + i % 173);
    media::Image rounded = truth;
    for (size_t i = 0; i < truth.rgba.size(); i += 4 * 7) rounded.rgba[i] = static_cast<uint8_t>(truth.rgba[i] + 1);
    EXPECT_TRUE(compare_with_golden(rounded, truth).passes());
    media::Image opaque = truth;
    for (size_t i = 3; i < truth.rgba.size(); i += 4) opaque.rgba[i] = 255;
    EXPECT_FALSE(compare_with_golden(opaque, truth).passes());
}

TEST(GoldenTolerance, BearsNoEdgeThatMovedByAPixel) {
    const auto edge_at = [](uint32_t column) {
        media::Image image(48, 32);
        for (uint32_t y = 0; y < image.height; ++y)
            for (uint32_t x = 0; x < image.width; ++x) {
                std::fill_n(image.at(x, y), 3, static_cast<uint8_t>(x < column ? 0 : 255));
                image.at(x, y)[3] = 255;
            }
        return image;
    };
    EXPECT_TRUE(compare_with_golden(edge_at(24), edge_at(24)).passes());
    EXPECT_FALSE(compare_with_golden(edge_at(25), edge_at(24)).passes());
}

TEST(GoldenFailure, LeavesTruthResultAndDifference) {
    if (std::getenv("NEUVV_ACCEPT_GOLDEN")) GTEST_SKIP() << "NEUVV_ACCEPT_GOLDEN is set: it would accept a wrong image";
    const TemporaryFolder folder;
    const media::Image wrong =
        swapped_red_and_blue(media::read_png(std::filesystem::path(NEUVV_GOLDEN_DIR) / "random_tree.png"));
    const std::string problem = check_golden("random_tree", wrong, folder.path);
    const std::filesystem::path file = folder.path / "random_tree.png";
    EXPECT_NE(problem.find(file.string()), std::string::npos) << problem;
    EXPECT_NE(problem.find("tests/golden/accept random_tree"), std::string::npos) << problem;
    EXPECT_EQ(media::read_png(file).width, 3 * wrong.width);
    EXPECT_NE(check_golden("no_such_golden", wrong, folder.path).find("no_such_golden"), std::string::npos);
    EXPECT_EQ(media::read_png(folder.path / "no_such_golden.png").width, wrong.width);
}

}  // namespace
}  // namespace neuvv::test

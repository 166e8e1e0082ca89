// Picking against the reference: the leaf that a ray meets, and its distance.
#include "render/volume/pick.h"
#include "media/image.h"

#include <gtest/gtest.h>

#include "reference/camera.h"
#include "reference/paint.h"
#include "reference/pick.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

using PickTest = GpuTest;

struct Agreement {
    uint32_t hits = 0, misses = 0, others = 0;  // others: rays for which leaf or hit differ
    double worst_m = 0, worst_colour = 0;
};

Agreement compare(const voctree::VOctree& tree, const std::vector<reference::LeafSlice>& slices,
                  const stage::Camera& camera, const std::vector<render::Picked>& picked, double alpha) {
    Agreement agreement;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            const auto truth = reference::pick(tree, slices, reference::camera_ray(camera, x, y), alpha);
            const render::Picked& found = picked[size_t{y} * camera.width + x];
            (truth ? agreement.hits : agreement.misses)++;
            if (truth.has_value() != found.hit() || (truth && truth->leaf != found.leaf)) ++agreement.others;
            if (truth && found.hit())
                agreement.worst_m = std::max(agreement.worst_m, std::abs(truth->distance_m - double{found.distance_m}));
            if (truth && found.hit())
                for (int channel = 0; channel < 3; ++channel)
                    agreement.worst_colour = std::max(agreement.worst_colour,
                                                      std::abs(truth->colour[channel] - double{found.colour[channel]}));
        }
    return agreement;
}

TEST_F(PickTest, FindsTheLeafWhereAlphaPassesAndHowFarThatIs) {
    for (uint32_t degree = 0; degree <= 2; ++degree) {
        voctree::VOctree tree =
            random_tree({.seed = degree + 3, .node_levels = 3, .leaves = 1500, .hh_degree = degree});
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 10;
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
        const stage::Camera camera = look_at({2.2, 1.9, 2.6}, {0, 0.4, 0}, 57, 41, 1.1);
        std::vector<PickRay> rays;
        for (uint32_t y = 0; y < camera.height; ++y)
            for (uint32_t x = 0; x < camera.width; ++x) rays.push_back(render::pick_ray(camera, {x + 0.5, y + 0.5}));
        voctree::EditLayer layer{voctree::painted_field(tree), {}};
        for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf += 3)
            layer.edits.push_back({leaf, 0, 4, glm::vec3(0), 0, leaf % 2 ? 8.0f : 0.0f});
        render::Picker picker(device(), field, render::PickColours::kYes), colourless(device(), field);
        for (const bool painted : {false, true})
            for (const float alpha : {0.5f, render::kPickAlpha}) {
                const render::PaintUse use{&layer};
                picker.show(1.5f, painted ? std::span(&use, 1) : std::span<const render::PaintUse>());
                std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 1.5);
                if (painted) reference::paint(slices, degree, {{&layer}}, 1.5);
                const Agreement agreement = compare(tree, slices, camera, picker.pick(rays, alpha), double{alpha});
                EXPECT_GT(agreement.hits, 100u);
                EXPECT_GT(agreement.misses, 100u);
                EXPECT_LE(agreement.others, 4u) << "fp16 densities may choose another at a leaf's border";
                EXPECT_LE(agreement.worst_m, 0.02);
                EXPECT_LE(agreement.worst_colour, 0.02);
                colourless.show(1.5f, painted ? std::span(&use, 1) : std::span<const render::PaintUse>());
                const Agreement without = compare(tree, slices, camera, colourless.pick(rays, alpha), double{alpha});
                EXPECT_EQ(without.worst_m, agreement.worst_m) << "colours change nothing else";
                EXPECT_GT(without.worst_colour, 0.2) << "the comparison notices another colour";
                const Agreement wrong = compare(tree, slices, camera, picker.pick(rays, alpha), 0.9 * double{alpha});
                EXPECT_GT(wrong.others, 20u) << "the comparison notices another alpha";
            }
    }
}

// Colours of a PlenOctree are summed as sRGB, as it is trained, and what is found is linear.
TEST_F(PickTest, ColoursOfPlenOctreesAreLinear) {
    voctree::VOctree tree = random_tree({.seed = 8, .node_levels = 3, .leaves = 1500, .hh_degree = 1});
    const render::Field linear = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    tree.has_srgb_colours = true;
    const render::Field srgb = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const stage::Camera camera = look_at({2.2, 1.9, 2.6}, {0, 0.4, 0}, 57, 41, 1.1);
    std::vector<PickRay> rays;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) rays.push_back(render::pick_ray(camera, {x + 0.5, y + 0.5}));
    const auto picked = [&](const render::Field& field) {
        render::Picker picker(device(), field, render::PickColours::kYes);
        picker.show(1.5f, {});
        return picker.pick(rays, 0.5f);
    };
    const auto summed = picked(linear), found = picked(srgb);
    size_t hits = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!found[i].hit()) continue;
        ++hits;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(double{found[i].colour[c]}, media::linear_from_srgb(double{summed[i].colour[c]}), 2e-3);
    }
    EXPECT_GT(hits, 100u);
}

}  // namespace
}  // namespace neuvv::test

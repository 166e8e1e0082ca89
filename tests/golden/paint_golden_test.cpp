// Images of painted figures against the committed ones: one for each tool, and one of the blends side by side.
#include <gtest/gtest.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>

#include "edit/brush.h"
#include "edit/project.h"
#include "golden/golden.h"
#include "render/frame/frame_renderer.h"
#include "support/figure.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kPaintedSide = 128;

media::Image smile(uint32_t side) {
    media::Image image(side, side);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / static_cast<double>(side) - glm::dvec2(0.43, 0.37);
            const bool eyes = glm::length(glm::abs(at - glm::dvec2(0, -0.03)) - glm::dvec2(0.05, 0)) < 0.022;
            const double mouth = glm::length(at - glm::dvec2(0, 0.02));
            const bool lips = mouth > 0.065 && mouth < 0.09 && at.y > 0.045;
            const bool cheeks = glm::length(glm::abs(at - glm::dvec2(0, 0.03)) - glm::dvec2(0.095, 0)) < 0.025;
            uint8_t* to = image.at(x, y);
            to[0] = eyes ? 20 : 220;
            to[1] = cheeks ? 120 : 20;
            to[2] = eyes ? 90 : cheeks ? 140 : 30;
            to[3] = eyes || lips ? 255 : cheeks ? 128 : 0;
        }
    return image;
}

struct PaintGolden : GpuTest {
    voctree::VOctree tree = figure_tree();
    edit::Canvas canvas{tree};
    render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer{device(), field, {2 * kPaintedSide, kPaintedSide, 2}};
    voctree::EditLayer layer{voctree::painted_field(tree), {}};

    media::Image image(const std::vector<render::Instance>& instances, const stage::Camera& camera) {
        render::FrameSettings settings;
        settings.instances = instances;
        settings.width = camera.width;
        settings.height = camera.height;
        settings.samples = 2;
        settings.resolve.background = {0.18f, 0.21f, 0.25f, 1};
        return renderer.render(camera, settings);
    }
    void add(const std::vector<voctree::LeafEdit>& edits, const edit::EditFrames& frames = {0, 1}) {
        voctree::add_edits(layer, edit::at_frames(canvas, edits, frames));
        EXPECT_EQ(voctree::defect_of(layer), "");
    }
    // From a position a little beside the camera of the tools.
    void expect_golden(const std::string& name, float frame = 0) {
        const stage::Camera camera = look_at({0.8, 0.75, 2.0}, {0.5, 0.45, 0.5}, kPaintedSide, kPaintedSide, 1.6);
        const render::PaintUse use{&layer};
        const media::Image painted = image({{frame, glm::mat4(1), renderer.paints().add({&use, 1})}}, camera);
        EXPECT_EQ(check_golden(name, painted), "");
        EXPECT_FALSE(compare_with_golden(image({{frame}}, camera), painted).passes()) << "paint shows";
    }
};

TEST_F(PaintGolden, AProjectedImage) {
    render::Picker picker(device(), field);
    picker.show(0);
    add(edit::project(picker, canvas, edit::densities(canvas, 0), smile(200), figure_camera(200)));
    expect_golden("paint_project");
}

TEST_F(PaintGolden, StrokesOfABrush) {
    render::Picker picker(device(), field);
    picker.show(0);
    const stage::Camera camera = figure_camera(200);
    const std::vector<float> sigma = edit::densities(canvas, 0);
    const auto line = [&](const edit::Brush& brush, const std::vector<glm::dvec2>& pixels) {
        add(edit::stroke(canvas, sigma, brush, edit::touches_under(picker, camera, pixels)));
    };
    line({0.05f, 0.2f, {0.9f, 0.02f, 0.02f}}, {{50, 60}, {120, 50}});
    line({0.03f, 0.9f, {0.02f, 0.1f, 0.9f}}, {{60, 150}, {80, 140}, {100, 155}, {120, 140}});
    line({0.09f, 1, glm::vec3(0), 0, 0}, {{105, 45}, {150, 10}});  // erases a piece
    expect_golden("paint_brush");
}

TEST_F(PaintGolden, RegionsErasedRecolouredAndBroughtToLife) {
    const glm::vec3 head(kHead);
    const edit::Region wedge =
        edit::without(edit::box_region({0.45f, 0.66f, 0.3f}, {1, 1, 1}), edit::sphere_region(head, 0.15f));
    add(edit::erase_leaves(edit::leaves_in(canvas, wedge, 0, 1)));
    const std::vector<uint32_t> shoulders = edit::leaves_in(canvas, edit::box_region({0, 0, 0}, {1, 0.36f, 1}), 0, 0);
    voctree::add_edits(layer, edit::shift_colours(canvas, shoulders, 0, 1, {140, 2.5f}));
    // A collar where leaves live only in the second frame.
    const std::vector<uint32_t> later =
        edit::all_leaves_in(canvas, edit::box_region({0.75f, 0.1f, 0.3f}, {1, 0.3f, 0.7f}));
    add(edit::set_density(later, 250), {0, 0});
    add(edit::fill_leaves(later, {1, 0.8f, 0.1f}, 1), {0, 0});
    expect_golden("paint_region");
}

TEST_F(PaintGolden, PaintThatFollowsTheSurfacesLeavesAndPaintThatDoesNot) {
    const std::vector<uint32_t> head = edit::leaves_in(canvas, edit::sphere_region(glm::vec3(kHead), 0.3f), 0, 0);
    std::vector<uint32_t> upper, lower;
    for (const uint32_t leaf : head) (canvas.centres[leaf].y > kHead.y ? upper : lower).push_back(leaf);
    add(edit::fill_leaves(upper, {0.9f, 0.1f, 0.1f}, 1), {0, 0, edit::Follow::kAll});
    add(edit::fill_leaves(lower, {0.1f, 0.1f, 0.9f}, 1), {0, 0, edit::Follow::kNot});
    expect_golden("paint_follow", 1);  // upper leaves that the head still fills are red, no lower leaf is blue
}

TEST_F(PaintGolden, BlendsBesideEachOther) {
    std::vector<voctree::LeafEdit> stripes;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        if (std::fmod(canvas.centres[leaf].y, 0.16f) < 0.08f)
            stripes.push_back({leaf, 0, 1, {0.1f, 0.3f, 0.9f}, canvas.centres[leaf].x < 0.45f ? 1.0f : 0.5f});
    add(stripes);
    const stage::PaintBlend blends[] = {stage::PaintBlend::kNormal, stage::PaintBlend::kMultiply,
                                        stage::PaintBlend::kTint, stage::PaintBlend::kRecolour};
    const stage::Camera camera = look_at({0.55, 0.8, 5}, {0.5, 0.42, 0.5}, 2 * kPaintedSide, kPaintedSide / 2, 1);
    const auto row = [&](bool painted) {
        std::vector<render::Instance> instances;
        for (int i = 0; i < 5; ++i) {
            const render::PaintUse use{&layer, blends[i % 4], 1};
            instances.push_back(
                {.frame = 0,
                 .world_from_performer = glm::translate(glm::mat4(1), {0.85f * static_cast<float>(i - 2), 0, 0}),
                 .paint = painted && i < 4 ? renderer.paints().add({&use, 1}) : 0});
        }
        return image(instances, camera);
    };
    const media::Image painted = row(true), plain = row(false);
    EXPECT_EQ(check_golden("paint_blends", painted), "");
    EXPECT_FALSE(compare_with_golden(plain, painted).passes());
    // The fifth has no paint, and the others' paint does not change it.
    for (uint32_t y = 0; y < painted.height; ++y)
        for (uint32_t x = 210; x < painted.width; ++x)
            EXPECT_TRUE(std::equal(painted.at(x, y), painted.at(x, y) + 4, plain.at(x, y)));
}

}  // namespace
}  // namespace neuvv::test

// Rays that are fewer than pixels: their positions, and the image that upscaling makes of them.
#include "render/rays/ray_grid.h"

#include <gtest/gtest.h>

#include "reference/trace.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/traced.h"

namespace neuvv::test::ray_grid_test {
namespace {

constexpr uint32_t kWidth = 91, kHeight = 57;
const render::Fovea kInset{{0.3, 0.2}, {0.7, 0.9}, 0.4};

using RayGridTest = GpuTest;

voctree::VOctree a_tree() {
    return random_tree({.seed = 4, .node_levels = 3, .leaves = 2500, .hh_degree = 1});
}

stage::Camera a_camera(const voctree::VOctree& tree) {
    return look_at(world_of(tree, {1.7, 1.4, 2.1}), world_of(tree, glm::dvec3(0.5)), kWidth, kHeight, 1.1);
}

render::FrameSettings settings_of(double scale, const std::vector<render::Fovea>& foveae) {
    render::FrameSettings settings;
    settings.instances = {{1.3f}};
    settings.width = kWidth;
    settings.height = kHeight;
    settings.scale = scale;
    settings.foveae = foveae;
    settings.stop = 0;
    return settings;
}

TEST(RayGrid, CoversTheImageOnceAndIsDenseInsideTheInset) {
    for (const double scale : {1.0, 0.7, 0.31, 0.01})
        for (const render::Fovea& fovea :
             {render::Fovea{}, kInset, render::Fovea{{0, 0}, {0.2, 1}, 0.5}, render::Fovea{{0.9, 1}, {1, 1}, 0.1}}) {
            const render::RayGrid grid = render::ray_grid(kWidth, kHeight, scale, fovea);
            for (const auto& [axis, rays, pixels] :
                 {std::tuple(grid.across, grid.rays.x, kWidth), std::tuple(grid.downwards, grid.rays.y, kHeight)}) {
                EXPECT_GE(rays, 1u);
                EXPECT_LE(rays, pixels);
                EXPECT_NEAR(render::pixel_of_ray(axis, 0), 0, 1e-4);
                EXPECT_NEAR(render::pixel_of_ray(axis, rays), pixels, 1e-4);
                double last = -1;
                for (double ray = 0; ray <= rays; ray += 0.25) {
                    const double pixel = render::pixel_of_ray(axis, ray);
                    EXPECT_GT(pixel, last);
                    EXPECT_NEAR(render::ray_of_pixel(axis, pixel), ray, 1e-4);
                    last = pixel;
                }
            }
        }
    const render::RayGrid inset = render::ray_grid(1000, 1000, 0.5, kInset);
    EXPECT_NEAR(inset.rays.x, 0.5 * (400 + 0.4 * 600), 3);
    EXPECT_NEAR(render::pixel_of_ray(inset.across, 121) - render::pixel_of_ray(inset.across, 120), 2, 0.02);
    EXPECT_NEAR(render::pixel_of_ray(inset.across, 21) - render::pixel_of_ray(inset.across, 20), 5, 0.05);
    EXPECT_EQ(render::ray_grid(kWidth, kHeight).rays, glm::uvec2(kWidth, kHeight));
}

TEST_F(RayGridTest, RaysStandWhereTheGridSays) {
    const voctree::VOctree tree = a_tree();
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera camera = a_camera(tree);
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 1.3f);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    for (const auto& [scale, foveae] :
         {std::pair(0.6, std::vector<render::Fovea>{}), std::pair(0.8, std::vector{kInset})}) {
        renderer.render(camera, settings_of(scale, foveae));
        const render::RayGrid grid =
            render::ray_grid(kWidth, kHeight, scale, foveae.empty() ? render::Fovea{} : foveae[0]);
        const std::vector<glm::vec4> light = renderer.radiance();
        ASSERT_EQ(light.size(), size_t{grid.rays.x} * grid.rays.y);
        double alpha = 0;
        for (uint32_t y = 0; y < grid.rays.y; ++y)
            for (uint32_t x = 0; x < grid.rays.x; ++x) {
                const reference::Ray ray =
                    reference::camera_ray(camera, render::pixel_of_ray(grid.across, x + 0.5) - 0.5,
                                          render::pixel_of_ray(grid.downwards, y + 0.5) - 0.5);
                const reference::RayResult truth = reference::trace(tree, slices, ray);
                ASSERT_NEAR(light[size_t{y} * grid.rays.x + x].a, truth.alpha, kHalfSteps / 255) << x << ' ' << y;
                alpha += truth.alpha;
            }
        EXPECT_GT(alpha, 20);
    }
}

// Light at a position between rays, by the filter of upscale.comp.
struct Filter {
    const std::vector<glm::vec4>& light;
    glm::uvec2 rays;

    glm::dvec4 at(int x, int y) const {
        const int column = std::clamp(x, 0, static_cast<int>(rays.x) - 1);
        const int row = std::clamp(y, 0, static_cast<int>(rays.y) - 1);
        return light[static_cast<size_t>(row) * rays.x + static_cast<size_t>(column)];
    }
    static glm::dvec4 weights(double t) {
        return 0.5 * glm::dvec4(-t + 2 * t * t - t * t * t, 2 - 5 * t * t + 3 * t * t * t,
                                t + 4 * t * t - 3 * t * t * t, -t * t + t * t * t);
    }
    static glm::dvec4 clamped(glm::dvec4 weights, const glm::dvec4 (&of)[4]) {
        const glm::dvec4 sum = weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2] + weights[3] * of[3];
        return glm::clamp(sum, glm::min(of[1], of[2]), glm::max(of[1], of[2]));
    }
    glm::dvec4 between(glm::dvec2 position) const {
        const glm::dvec2 first = glm::floor(position - 0.5), part = position - 0.5 - first;
        glm::dvec4 rows[4];
        for (int y = 0; y < 4; ++y) {
            glm::dvec4 row[4];
            for (int x = 0; x < 4; ++x)
                row[x] = at(static_cast<int>(first.x) + x - 1, static_cast<int>(first.y) + y - 1);
            rows[y] = clamped(weights(part.x), row);
        }
        return clamped(weights(part.y), rows);
    }
};

TEST_F(RayGridTest, ImagesAreUpscaledByCatmullRomWithoutHalos) {
    const voctree::VOctree tree = a_tree();
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera camera = a_camera(tree);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    for (const auto& [scale, foveae] :
         {std::pair(0.45, std::vector<render::Fovea>{}), std::pair(1.0, std::vector{kInset})}) {
        render::FrameSettings settings = settings_of(scale, foveae);
        settings.resolve.background = {0.1f, 0.2f, 0.3f, 1};
        const media::Image image = renderer.render(camera, settings);
        const render::RayGrid grid =
            render::ray_grid(kWidth, kHeight, scale, foveae.empty() ? render::Fovea{} : foveae[0]);
        const std::vector<glm::vec4> light = renderer.radiance();
        const Filter filter{light, grid.rays};
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const glm::dvec4 truth = filter.between(
                    {render::ray_of_pixel(grid.across, x + 0.5), render::ray_of_pixel(grid.downwards, y + 0.5)});
                for (int c = 0; c < 3; ++c) {
                    const double expected =
                        reference::display_value(truth[c] + (1 - truth.a) * settings.resolve.background[c]);
                    ASSERT_NEAR(image.at(x, y)[c], 255 * expected, 0.6) << x << ' ' << y;
                }
            }
    }
}

TEST_F(RayGridTest, TheInsetIsTheImageItself) {
    const voctree::VOctree tree = a_tree();
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera camera = a_camera(tree);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    for (const render::Show show : {render::Show::kColour, render::Show::kDepth}) {
        render::FrameSettings whole = settings_of(1, {}), inset = settings_of(1, {kInset}), even = inset;
        even.foveae[0].beside = 1;
        for (render::FrameSettings* settings : {&whole, &inset, &even})
            settings->resolve = {.show = show, .depth_near_m = 1, .depth_far_m = 6};
        const media::Image truth = renderer.render(camera, whole);
        EXPECT_EQ(renderer.render(camera, even).rgba, truth.rgba);
        const media::Image foveated = renderer.render(camera, inset);
        const GridAxis across = render::ray_grid(kWidth, kHeight, 1, kInset).across;
        size_t other = 0;
        for (uint32_t y = 15; y < 45; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const bool same = std::equal(truth.at(x, y), truth.at(x, y) + 4, foveated.at(x, y));
                if (x >= static_cast<double>(across.knots.z) && x < static_cast<double>(across.knots.w))
                    ASSERT_TRUE(same) << x << ' ' << y;
                else
                    other += !same;
            }
        EXPECT_GT(other, 50u);
        EXPECT_EQ(renderer.render(camera, whole).rgba, truth.rgba);
    }
}

TEST_F(RayGridTest, ViewsHaveGridsOfTheirOwn) {
    const voctree::VOctree tree = a_tree();
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera cameras[] = {a_camera(tree), a_camera(tree)};
    const render::Fovea left = kInset, right{{0.05, 0.3}, {0.4, 0.5}, 0.7};
    render::FrameRenderer both(device(), field, {kWidth, kHeight, 1, 2}), alone(device(), field, {kWidth, kHeight});
    const std::vector<media::Image> images = both.render_views(cameras, settings_of(0.9, {left, right}));
    EXPECT_EQ(images[0].rgba, alone.render(cameras[0], settings_of(0.9, {left})).rgba);
    EXPECT_EQ(images[1].rgba, alone.render(cameras[1], settings_of(0.9, {right})).rgba);
    EXPECT_NE(images[0].rgba, images[1].rgba);
}

}  // namespace
}  // namespace neuvv::test::ray_grid_test

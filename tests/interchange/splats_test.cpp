// Splats of leaves: their colours from all sides, where they are placed, and their images against the reference's.
#include "interchange/splats/splats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "interchange/splats/fit_splats.h"
#include "interchange/splats/shown_leaves.h"
#include "interchange/splats/splat_ply.h"
#include "media/image.h"
#include "reference/hh.h"
#include "reference/splats.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

using interchange::Splats;

slice::Slice some_volume(uint32_t degree) {
    return voctree::slice_of(random_tree({.seed = 7, .node_levels = 2, .leaves = 150, .bases = 4, .hh_degree = degree}),
                             2);
}

glm::dvec3 direction(Random& random) {
    return glm::normalize(glm::dvec3(random.bell(), random.bell(), random.bell()));
}

glm::dvec3 shown_by_splat(const Splats& splats, size_t i, const glm::dvec3& d) {
    const std::vector<double> basis = reference::sh_basis(splats.degree, d);
    glm::dvec3 sum(0.5);
    for (int l = 0; l <= static_cast<int>(splats.degree); ++l)
        for (int m = -l; m <= l; ++m) {
            const uint32_t k = reference::sh_index(l, m);
            sum += (m % 2 == 0 ? 1 : -1) * basis[k] * glm::dvec3(splats.splats[i].colour[k]);
        }
    return sum;
}

glm::dvec3 shown_by_leaf(const slice::Slice& volume, size_t i, const glm::dvec3& d) {
    const std::vector<double> basis = reference::sh_basis(volume.degree, d);
    glm::dvec3 shown;
    for (int c = 0; c < 3; ++c) {
        double logit = 0;
        for (size_t k = 0; k < basis.size(); ++k)
            logit += basis[k] * double{volume.leaves[i].colours[static_cast<size_t>(c)][k]};
        shown[c] = media::srgb_from_linear(1 / (1 + std::exp(-logit)));
    }
    return shown;
}

// The camera of a .ply for one of ours: the world is turned about z, the camera about x.
reference::SplatCamera ply_camera(const stage::Camera& camera) {
    const glm::dmat3 about_x(1, 0, 0, 0, -1, 0, 0, 0, -1), about_z(-1, 0, 0, 0, -1, 0, 0, 0, 1);
    return {about_x * glm::transpose(glm::dmat3(camera.world_from_camera)) * about_z,
            about_z * glm::dvec3(camera.world_from_camera[3]),
            camera.fx,
            camera.fy,
            camera.cx,
            camera.cy,
            static_cast<int>(camera.width),
            static_cast<int>(camera.height)};
}

stage::Camera some_camera() {
    stage::Camera camera;
    camera.width = 48;
    camera.height = 40;
    camera.fx = 50;
    camera.fy = 55;
    camera.cx = 23;
    camera.cy = 21;
    camera.world_from_camera = look_at({1.5, 1.2, 2.5}, {0, 0.4, 0}, 1, 1).world_from_camera;
    return camera;
}

TEST(Splats, HaveTheColoursOfLeaves) {
    for (const uint32_t degree : {0u, 1u, 2u, 3u}) {
        const slice::Slice volume = some_volume(degree);
        const Splats splats = interchange::splats_of(volume, {0.4, 0.7});
        ASSERT_EQ(splats.splats.size(), volume.leaves.size());
        Random random(3);
        double worst = 0, sum = 0;
        for (size_t i = 0; i < splats.splats.size(); ++i) {
            const glm::dvec3 d = direction(random);
            const glm::dvec3 difference = glm::abs(shown_by_splat(splats, i, d) - shown_by_leaf(volume, i, d));
            for (int c = 0; c < 3; ++c) {
                worst = std::max(worst, difference[c]);
                sum += difference[c];
            }
            const double edge = double{volume.edge_m(volume.leaves[i])};
            EXPECT_NEAR(double{splats.splats[i].opacity}, 1 - std::exp(-0.7 * double{volume.leaves[i].sigma} * edge),
                        1e-5);
        }
        // The sigmoid and sRGB are no polynomials: what is projected onto so few harmonics is a little off.
        EXPECT_LT(worst, degree == 0 ? 1e-5 : 0.2) << degree;
        EXPECT_LT(sum / static_cast<double>(3 * splats.splats.size()), degree == 0 ? 1e-5 : 0.03) << degree;
    }
}

// A splat that is turned shows from the turned direction what it showed before.
TEST(Splats, AreTurnedWithTheirColours) {
    const slice::Slice volume = some_volume(3);
    const glm::dquat turned = glm::normalize(glm::dquat(0.3, -0.5, 0.7, 0.2));
    const Splats here = interchange::splats_of(volume, {}), there = interchange::splats_of(volume, {}, turned);
    Random random(5);
    for (size_t i = 0; i < here.splats.size(); ++i) {
        const glm::dvec3 centre = turned * glm::dvec3(here.splats[i].centre);
        EXPECT_LT(glm::distance(centre, glm::dvec3(there.splats[i].centre)), 1e-5);
        EXPECT_LT(glm::distance(here.splats[i].deviation, there.splats[i].deviation), 1e-6f);
        const glm::dvec3 d = direction(random);
        EXPECT_LT(glm::distance(shown_by_splat(here, i, d), shown_by_splat(there, i, turned * d)), 0.06);
    }
}

// The file as an independent reader sees it, drawn by the definition.
TEST(Splats, LookAsTheirFileDoesByTheDefinition) {
    const slice::Slice volume = some_volume(2);
    const interchange::SplatShape shape{0.45, 0.8};
    const TemporaryFolder folder;
    interchange::write_splat_ply(folder.path / "x.ply",
                                 interchange::splats_of(volume, shape, interchange::kPlyRotation));
    EXPECT_LT(
        std::filesystem::file_size(folder.path / "x.ply") - volume.leaves.size() * interchange::ply_bytes_of_splat(2),
        2000u);
    const auto truth =
        reference::draw_splats(reference::read_splats(folder.path / "x.ply"), ply_camera(some_camera()), glm::dvec3(1));
    const media::Image image =
        interchange::splat_image(interchange::splats_of(volume, shape), some_camera(), glm::vec3(1));
    double sum = 0, coverage = 0;
    for (size_t i = 0; i < truth.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const double shown = image.rgba[4 * i + static_cast<size_t>(c)] / 255.0;
            EXPECT_NEAR(shown, truth[i][c], 0.03);
            sum += std::abs(shown - truth[i][c]);
            coverage += 1 - truth[i][c];
        }
    EXPECT_LT(sum / static_cast<double>(3 * truth.size()), 0.003);
    EXPECT_GT(coverage / static_cast<double>(3 * truth.size()), 0.03) << "something is seen";
}

// Of an opaque block of 4 × 4 × 4 leaves, the inner 2 × 2 × 2 are hidden from everywhere.
TEST(Splats, SayWhichLeavesAreShown) {
    slice::Slice volume;
    volume.depth = 4;
    for (uint32_t z = 6; z < 10; ++z)
        for (uint32_t y = 6; y < 10; ++y)
            for (uint32_t x = 6; x < 10; ++x)
                volume.leaves.push_back({voctree::first_cell({x, y, z, 4}, 4), 4, 400, {}, 1});
    interchange::measure_shown(volume);
    double outer = 0, inner = 0;
    for (const slice::Leaf& leaf : volume.leaves) {
        const voctree::LeafPosition at = voctree::position_of(leaf.cell, 4);
        const auto inside = [](uint32_t c) { return c == 7 || c == 8; };
        const bool hidden = inside(at.x) && inside(at.y) && inside(at.z);
        (hidden ? inner : outer) += double{leaf.shown} - 0.1;  // of what the slice said a tenth is left
    }
    EXPECT_LT(inner / 8, outer / 56 / 3) << "Gaussians do not close the gaps between them";
    // What is seen of a cube of a quarter from 26 directions: the mean of its faces' area times the cosine, if not more
    // than the splats' soft edges.
    EXPECT_NEAR(outer, 0.0625 * (6 * 1 + 12 * std::sqrt(2.0) + 8 * std::sqrt(3.0)) / 26, 0.02);
}

// Leaves that no image shows are not typical, and one that makes up all of an image is typical of it.
TEST(Splats, TypicalLeavesAreThoseThatImagesShow) {
    slice::Slice volume = some_volume(1);
    ASSERT_GT(volume.leaves.size(), 20u);
    for (slice::Leaf& leaf : volume.leaves) leaf.shown = 0;
    volume.leaves[3].shown = 1;
    volume.leaves[10].shown = 3;
    std::vector<uint64_t> cells;
    for (const slice::Leaf& leaf : interchange::typical_leaves(volume, 4)) cells.push_back(leaf.cell);
    const uint64_t first = volume.leaves[3].cell, second = volume.leaves[10].cell;
    EXPECT_EQ(cells, (std::vector<uint64_t>{first, second, second, second}));
    volume.leaves.resize(1);
    volume.leaves[0].shown = 0.5f;
    EXPECT_EQ(interchange::typical_leaves(volume, 4).size(), 4u);
}

TEST(Splats, CloseUpsShowALeafInTheCentre) {
    const slice::Slice volume = some_volume(1);
    const stage::Camera whole = some_camera();
    for (const size_t i : {size_t{0}, volume.leaves.size() / 2, volume.leaves.size() - 1}) {
        const slice::Leaf& leaf = volume.leaves[i];
        const stage::Camera close = interchange::close_up(whole, volume, leaf);
        EXPECT_EQ(close.world_from_camera, whole.world_from_camera);
        const glm::dvec3 at(glm::inverse(close.world_from_camera) * glm::dvec4(volume.centre_m(leaf), 1));
        EXPECT_NEAR(close.cx - close.fx * at.x / at.z, 0.5 * close.width, 1e-6);
        EXPECT_NEAR(close.cy + close.fy * at.y / at.z, 0.5 * close.height, 1e-6);
        const double whole_pixels = whole.fx * double{volume.edge_m(leaf)} / -at.z;
        EXPECT_NEAR(close.fx * double{volume.edge_m(leaf)} / -at.z, std::max(4.0, whole_pixels), 1e-5);
        EXPECT_NEAR(close.fy / close.fx, whole.fy / whole.fx, 1e-12);
    }
}

// Images of splats of a shape from two sides.
std::vector<interchange::FitView> views_of(const slice::Slice& volume, const interchange::SplatShape& shape) {
    stage::Camera camera = some_camera();
    std::vector<interchange::FitView> views;
    for (const glm::dvec3 eye : {glm::dvec3(1.5, 1.2, 2.5), glm::dvec3(-2, 0.5, 1.5)}) {
        camera.world_from_camera = look_at(eye, {0, 0.4, 0}, 1, 1).world_from_camera;
        views.push_back(
            {camera, interchange::splat_image(interchange::splats_of(volume, shape), camera, glm::vec3(1))});
    }
    return views;
}

// Wide, faint splats look much like narrow, dense ones: on the way from one to the other, neither width nor density
// alone improves the images.
TEST(Splats, AreFittedWhereWidthAndDensityChangeTogether) {
    const slice::Slice volume = some_volume(1);
    for (const interchange::SplatShape shape : {interchange::SplatShape{0.6, 0.2}, {0.5, 0.25}}) {
        const interchange::SplatFit fit = interchange::fit_shape(volume, views_of(volume, shape), [] {});
        EXPECT_NEAR(fit.shape.width, shape.width, 0.03);
        EXPECT_NEAR(fit.shape.density, shape.density, 0.02);
        EXPECT_GT(fit.psnr, 50);
    }
}

// Images of splats of another shape lead back to that shape.
TEST(Splats, AreFittedToImages) {
    const slice::Slice volume = some_volume(1);
    const interchange::SplatShape shape{0.42, 1.1};
    const std::vector<interchange::FitView> views = views_of(volume, shape);
    size_t times = 0;
    const interchange::SplatFit fit = interchange::fit_shape(volume, views, [&] { times++; });
    EXPECT_NEAR(fit.shape.width, shape.width, 0.03);
    EXPECT_NEAR(fit.shape.density, shape.density, 0.08);
    EXPECT_GT(fit.psnr, 40);
    EXPECT_LT(times, 60u);
    EXPECT_GT(fit.psnr, 3 + interchange::psnr_of(interchange::splats_of(volume, {}), views));
}

// Two walls of opaque leaves, red before blue. Where a leaf is half a pixel long, splats look right that renderers must
// widen to close their gaps; those that were fitted to a close-up hide what is behind them from near as well.
TEST(Splats, FittedToCloseUpsHideWhatIsBehindThem) {
    constexpr uint32_t kDepth = 7, kBegin = 32, kEnd = 96;
    slice::Slice volume;
    volume.depth = kDepth;
    for (const uint32_t z : {40u, 41u, 64u, 65u})
        for (uint32_t y = kBegin; y < kEnd; ++y)
            for (uint32_t x = kBegin; x < kEnd; ++x) {
                const float red = z >= 64 ? 20 : -20;  // a logit by the constant harmonic
                volume.leaves.push_back(
                    {voctree::first_cell({x, y, z, kDepth}, kDepth), kDepth, 2 << kDepth, {{{red}, {-20}, {-red}}}, 1});
            }
    stage::Camera whole;
    whole.width = whole.height = 48;
    whole.cx = whole.cy = 24;
    whole.fx = whole.fy = 192;
    whole.world_from_camera = glm::translate(glm::dmat4(1), {0.5, 0.5, 3.5});
    const stage::Camera close = interchange::close_up(whole, volume, volume.leaves[volume.leaves.size() / 2]);
    // Red where a ray meets the first wall: x and y between a quarter and three quarters, 66/128 before the origin.
    const auto seen = [](const stage::Camera& camera) {
        media::Image image(camera.width, camera.height);
        for (uint32_t y = 0; y < camera.height; ++y)
            for (uint32_t x = 0; x < camera.width; ++x) {
                const double away = 3.5 - 66.0 / 128;
                const double at_x = 0.5 + away * (x + 0.5 - camera.cx) / camera.fx;
                const double at_y = 0.5 - away * (y + 0.5 - camera.cy) / camera.fy;
                const bool hit = std::max(std::abs(at_x - 0.5), std::abs(at_y - 0.5)) < 0.25;
                const std::array<uint8_t, 4> colour = {255, uint8_t(hit ? 0 : 255), uint8_t(hit ? 0 : 255), 255};
                std::copy(colour.begin(), colour.end(), image.at(x, y));
            }
        return image;
    };
    const std::vector<interchange::FitView> far_view = {{whole, seen(whole)}}, near_view = {{close, seen(close)}};
    const auto psnr = [&](const interchange::SplatShape& shape, const std::vector<interchange::FitView>& views) {
        return interchange::psnr_of(interchange::splats_of(volume, shape), views);
    };
    const interchange::SplatShape by_far = interchange::fit_shape(volume, far_view, [] {}).shape;
    const interchange::SplatShape by_near = interchange::fit_shape(volume, near_view, [] {}).shape;
    EXPECT_GT(psnr(by_far, far_view), 20);
    EXPECT_LT(psnr(by_far, near_view), 10);
    EXPECT_GT(psnr(by_near, near_view), 20);
}

}  // namespace
}  // namespace neuvv::test

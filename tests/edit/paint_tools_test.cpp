// Tools on a figure: which leaves they select, with which colours, and at which frames.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "edit/brush.h"
#include "edit/carry.h"
#include "edit/project.h"
#include "reference/camera.h"
#include "reference/pick.h"
#include "reference/sample.h"
#include "reference/slice.h"
#include "reference/trace.h"
#include "render/volume/trace.h"
#include "support/figure.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

TEST(Canvas, KnowsPlacesDensitiesAndColoursAsTheReferenceDoes) {
    for (uint32_t degree = 0; degree <= 3; ++degree) {
        const voctree::VOctree tree =
            random_tree({.seed = 4 + degree, .node_levels = 2, .leaves = 300, .hh_degree = degree});
        const edit::Canvas canvas(tree);
        for (const float frame : {0.0f, 1.25f, 4.0f}) {
            const std::vector<reference::LeafSlice> truth = reference::slice_tree(tree, double{frame});
            const std::vector<float> sigma = edit::densities(canvas, frame);
            for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
                EXPECT_NEAR(sigma[leaf], truth[leaf].sigma, 1e-4);
                const glm::vec3 colour = edit::mean_colour(tree, voctree::RowsAtTime(tree, double{frame}), leaf);
                for (int c = 0; c < 3; ++c) {
                    const double k = truth[leaf].k[static_cast<size_t>(c)][0];
                    EXPECT_NEAR(colour[c], 1 / (1 + std::exp(-0.28209479 * k)), 1e-4);
                }
                const glm::dvec3 at =
                    (glm::dvec3(canvas.centres[leaf]) - glm::dvec3(tree.box_min)) / glm::dvec3(tree.box_size);
                EXPECT_EQ(voctree::find_leaf(tree, at), leaf);
            }
        }
    }
}

TEST(Regions, CombineAndChooseTheLeavesThatLive) {
    const voctree::VOctree tree = figure_tree();
    const edit::Canvas canvas(tree);
    const edit::Region head = edit::sphere_region(glm::vec3(kHead), static_cast<float>(kHeadRadius));
    const edit::Region right = edit::box_region({0.45f, 0, 0}, {1, 1, 1});
    const auto count = [&](const edit::Region& region, float first, float last) {
        const std::vector<uint32_t> leaves = edit::leaves_in(canvas, region, first, last);
        for (const uint32_t leaf : leaves) EXPECT_TRUE(region(canvas.centres[leaf]));
        return leaves.size();
    };
    const double cells = 4.0 / 3 * M_PI * std::pow(kHeadRadius * kFigureSide, 3);
    EXPECT_NEAR(static_cast<double>(count(head, 0, 0)), cells, 0.02 * cells);
    EXPECT_EQ(count(edit::both(head, right), 0, 0) + count(edit::without(head, right), 0, 0), count(head, 0, 0));
    EXPECT_EQ(count(edit::either(head, right), 0, 0), count(right, 0, 0) + count(edit::without(head, right), 0, 0));
    EXPECT_LT(count(head, 1, 1), count(head, 0, 0)) << "the head has left some of it";
    EXPECT_EQ(count(head, 0.5f, 0.75f), count(head, 0, 0)) << "between the frames both are there";
    EXPECT_EQ(count(head, 0.5f, 0.75f), count(head, 0, 1));
    EXPECT_EQ(edit::all_leaves_in(canvas, [](glm::vec3) { return true; }).size(), tree.leaf_count);
}

TEST(EditFrames, FollowWhatIsOpaque) {
    voctree::VOctree tree = random_tree({.seed = 2, .leaves = 1, .bases = 8, .frames = 8});
    for (uint32_t i = 0; i < 64; ++i) tree.sigma_basis[i] = i % 9 == 0 ? 1.0f : 0.0f;  // one basis per frame
    const float dense[8] = {50, 50, 0, 0.001f, 50, 50, 50, -3};
    std::copy(dense, dense + 8, tree.leaf(0));
    const edit::Canvas canvas(tree);
    const voctree::LeafEdit red{0, 0, 0, {1, 0, 0}, 0.5f};
    const auto spans = [&](const edit::EditFrames& frames) {
        std::vector<std::pair<float, float>> found;
        for (const voctree::LeafEdit& edit : edit::at_frames(canvas, {&red, 1}, frames))
            found.emplace_back(edit.first, edit.last);
        return found;
    };
    const std::pair<float, float> early(0, std::nextafter(2.0f, 0.0f)),
        late(std::nextafter(3.0f, 4.0f), std::nextafter(7.0f, 6.0f));
    using Spans = std::vector<std::pair<float, float>>;
    EXPECT_EQ(spans({5, 5, edit::Follow::kNot}), (Spans{{5, 5}}));
    EXPECT_EQ(spans({5, 5, edit::Follow::kRun}), Spans{late});
    EXPECT_EQ(spans({5, 5, edit::Follow::kAll}), (Spans{early, late}));
    EXPECT_EQ(spans({3, 3, edit::Follow::kRun}), (Spans{{3, 3}})) << "hardly there";
    EXPECT_EQ(spans({1, 3, edit::Follow::kRun}), (Spans{{0, 3}})) << "joined, so that no alpha counts twice";
}

TEST(Brushes, FadeFromHardnessToRadiusAndEndWhereTheSurfaceDoes) {
    const voctree::VOctree tree = figure_tree();
    const edit::Canvas canvas(tree);
    const std::vector<float> sigma = edit::densities(canvas, 0);
    const glm::vec3 a(kHead), b = a + glm::vec3(0, 0.08f, 0), far = a - glm::vec3(0, 0.4f, 0);
    const edit::Brush brush{0.06f, 0.5f, {0, 0, 1}, 0.8f, 12};
    std::set<uint32_t> touched;
    for (const voctree::LeafEdit& edit :
         edit::stroke(canvas, sigma, brush, std::vector<edit::Touch>{{a, a}, {b, b}, {far, far}})) {
        EXPECT_GT(sigma[edit.leaf], 0);
        const glm::vec3 at = canvas.centres[edit.leaf];
        const float along = glm::clamp((at.y - a.y) / 0.08f, 0.0f, 1.0f);
        const float away = std::min(glm::distance(at, a + along * (b - a)), glm::distance(at, far));
        EXPECT_LT(away, brush.radius_m);
        EXPECT_NEAR(edit.alpha, away < 0.03f ? 0.8f : 0.8f * glm::smoothstep(0.06f, 0.03f, away), 1e-3f);
        EXPECT_EQ(edit.sigma >= 0, edit.alpha >= 0.4f);
        touched.insert(edit.leaf);
    }
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        const bool inside = glm::distance(canvas.centres[leaf], a) < 0.059f && sigma[leaf] > 0;
        EXPECT_TRUE(!inside || touched.contains(leaf));
    }
    EXPECT_FALSE(touched.contains(voctree::find_leaf(tree, glm::dvec3(glm::mix(b, far, 0.5f)))))
        << "not joined over a gap";
}

TEST(ColourShifts, TurnTheHueAndKeepTheLuminance) {
    const auto luminance = [](glm::vec3 c) { return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f)); };
    const glm::vec3 skin(0.6f, 0.4f, 0.3f);
    EXPECT_LT(glm::distance(edit::shifted(skin, {}), skin), 1e-6f);
    EXPECT_LT(glm::distance(edit::shifted(skin, {360, 1}), skin), 1e-5f);
    const glm::vec3 grey = edit::shifted(skin, {0, 0});
    EXPECT_NEAR(grey.r, grey.b, 1e-6f);
    for (float hue = 0; hue < 360; hue += 15)
        EXPECT_NEAR(luminance(edit::shifted(skin, {hue, 1.5f})), luminance(skin), 1e-5f) << hue;
    const glm::vec3 turned = edit::shifted(skin, {120, 1});
    EXPECT_GT(turned.g, turned.r);
    EXPECT_GT(turned.g, turned.b) << "red turns to green";
}

TEST(ThroughBetween, ReachesToWhereTheFieldHasFaded) {
    const auto spans_of = [](const std::vector<std::pair<float, float>>& spans, float first, float last) {
        std::vector<voctree::LeafEdit> edits;
        for (const auto& [from, to] : spans) edits.push_back({3, from, to, glm::vec3(1), 1});
        edits.push_back({2, 4, 4, glm::vec3(1), 1});
        std::vector<std::pair<float, float>> found;
        for (const voctree::LeafEdit& edit : edit::extend_between_frames(edits, first, last))
            found.emplace_back(edit.first, edit.last);
        found.erase(found.begin());  // the edit of another leaf
        return found;
    };
    using Spans = std::vector<std::pair<float, float>>;
    const auto after = [](float frame) { return std::nextafter(frame, 100.0f); };
    const auto before = [](float frame) { return std::nextafter(frame, -100.0f); };
    EXPECT_EQ(spans_of({{5, 5}}, 0, 9), (Spans{{after(4), before(6)}}));
    EXPECT_EQ(spans_of({{5, 5}, {6, 6}}, 0, 9), (Spans{{after(4), before(5.5f)}, {5.5f, before(7)}}));
    EXPECT_EQ(spans_of({{7, 8}, {2, 4}}, 0, 9), (Spans{{after(1), before(5)}, {after(6), before(9)}}));
    EXPECT_EQ(spans_of({{2, 2}, {4, 4}}, 2, 9), (Spans{{2, before(3)}, {after(3), before(5)}})) << "frame 3 is its own";
    EXPECT_EQ(spans_of({{3.5f, 3.5f}, {7, 7}}, 3.25f, 7), (Spans{{3.25f, before(4)}, {after(6), 7}}));
}

TEST(ColourShifts, AreOfEachFramesOwnColour) {
    // Leaves that live at some frames and whose colour turns with their hyper angle.
    const voctree::VOctree tree = random_tree({.seed = 12, .leaves = 200, .bases = 6, .hh_degree = 1, .frames = 6});
    const edit::Canvas canvas(tree);
    std::vector<uint32_t> leaves;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf += 2) leaves.push_back(leaf);
    const edit::ColourShift shift{120, 1};
    const std::vector<voctree::LeafEdit> edits = edit::shift_colours(canvas, leaves, 1, 5, shift);
    voctree::EditLayer layer{voctree::painted_field(tree), {}};
    voctree::add_edits(layer, edits);
    EXPECT_EQ(voctree::defect_of(layer), "");
    EXPECT_EQ(layer.edits.size(), edits.size()) << "none over another";
    size_t live = 0, changing = 0;
    for (float frame = 1; frame <= 5; ++frame) {
        const std::vector<float> sigma = edit::densities(canvas, frame);
        for (const uint32_t leaf : leaves) {
            const auto found = std::find_if(edits.begin(), edits.end(), [&](const voctree::LeafEdit& edit) {
                return edit.leaf == leaf && edit.first <= frame && frame <= edit.last;
            });
            ASSERT_EQ(found != edits.end(), sigma[leaf] > 0) << leaf << " at " << frame;
            if (found == edits.end()) continue;
            ++live;
            changing += found->first > 1 && found->last < 5;
            const glm::vec3 want =
                edit::shifted(edit::mean_colour(tree, voctree::RowsAtTime(tree, double{frame}), leaf), shift);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(std::sqrt(found->colour[c]), std::sqrt(want[c]), 0.0601) << leaf << " at " << frame;
        }
    }
    EXPECT_GT(live, leaves.size());
    EXPECT_GT(changing, 0u);
}

using ToolsTest = GpuTest;

// An image with columns of red, transparent, green and blue, and white below.
media::Image columns(uint32_t side) {
    media::Image image(side, side);
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t column = 4 * x / side;
            uint8_t* to = image.at(x, y);
            to[0] = column == 0 || y > side / 2 ? 255 : 0;
            to[1] = column == 2 || y > side / 2 ? 255 : 0;
            to[2] = column == 3 || y > side / 2 ? 255 : 0;
            to[3] = column == 1 ? 0 : 255;
        }
    return image;
}

// The ray of a pixel of a camera in the world, in the space of a performer: by the transform itself, not by a
// transformed camera.
reference::Ray ray_in_performer(const stage::Camera& camera, uint32_t x, uint32_t y,
                                const glm::dmat4& world_from_performer) {
    const reference::Ray ray = reference::camera_ray(camera, x, y);
    const glm::dmat4 inverse = glm::inverse(world_from_performer);
    reference::Ray inside = ray;
    inside.origin = glm::dvec3(inverse * glm::dvec4(ray.origin, 1));
    inside.direction = glm::normalize(glm::dmat3(inverse) * ray.direction);
    return inside;
}

struct Standing {
    const char* name;
    glm::dmat4 world_from_performer;
};
// The transform in single precision, as performers have it.
std::vector<Standing> standings() {
    const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1), {3, -1, 2}), 0.7, {0.2, 1, -0.3});
    glm::dmat4 sheared = turned;
    sheared[1] += 0.8 * turned[0] - 0.3 * turned[2];
    sheared[2] -= 0.5 * turned[0];
    std::vector<Standing> all = {{"as it is", glm::dmat4(1)},
                                 {"turned", turned},
                                 {"stretched", glm::scale(turned, {0.5, 2, 1.5})},
                                 {"flat", glm::scale(turned, {1, 1, 0.2})},
                                 {"sheared, ten times as large", glm::scale(sheared, glm::dvec3(10))},
                                 {"mirrored", glm::scale(sheared, {-1, 1, 2})}};
    for (Standing& one : all) one.world_from_performer = glm::dmat4(glm::mat4(one.world_from_performer));
    return all;
}

// A camera in the world that has figure_camera's position in the performer's space. The figure just fills the image.
stage::Camera camera_before(const Standing& standing, uint32_t side) {
    const auto at = [&](const glm::dvec3& point) {
        return glm::dvec3(standing.world_from_performer * glm::dvec4(point, 1));
    };
    stage::Camera camera = look_at(at({0.55, 0.62, 2.1}), at({0.5, 0.45, 0.5}), side, side, 1.6);
    double widest = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner =
            glm::mix(glm::dvec3(0.1, 0, 0.25), glm::dvec3(0.8, 0.86, 0.75), glm::dvec3(i & 1, i >> 1 & 1, i >> 2));
        const glm::dvec3 seen(glm::inverse(camera.world_from_camera) * glm::dvec4(at(corner), 1));
        widest = std::max({widest, std::abs(seen.x / seen.z), std::abs(seen.y / seen.z)});
    }
    camera.fx = camera.fy = 0.5 * side / widest;
    return camera;
}

// What is wrong with a projected image of columns, according to the rays of the reference.
struct ProjectionFaults {
    uint32_t seen = 0, holes = 0, wrong = 0, behind = 0;
};
ProjectionFaults faults_of(const voctree::VOctree& tree, const edit::Canvas& canvas,
                           const std::vector<voctree::LeafEdit>& edits, const Standing& standing, uint32_t side) {
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
    std::vector<float> alpha(tree.leaf_count);
    std::vector<glm::vec3> colour(tree.leaf_count);
    for (const voctree::LeafEdit& edit : edits) {
        alpha[edit.leaf] = edit.alpha;
        colour[edit.leaf] = edit.colour;
    }
    const stage::Camera fine = camera_before(standing, 240);
    ProjectionFaults faults;
    for (uint32_t y = 1; y < 240; y += 2)
        for (uint32_t x = 1; x < 240; ++x) {
            const uint32_t column = 4 * x / 240, within = x % 60;
            const uint32_t margin = side < 40 ? 24 : 9;
            if (within < margin || within > 60 - margin || (y > 100 && y < 140)) continue;
            double transmittance = 1;
            for (const reference::LeafInterval& interval :
                 reference::intersect(tree, ray_in_performer(fine, x, y, standing.world_from_performer))) {
                const double density = slices[interval.leaf].sigma;
                if (density <= 0) continue;
                ++faults.seen;
                if (column == 1) {
                    faults.wrong += alpha[interval.leaf] > 0.5f;
                } else {
                    faults.holes += alpha[interval.leaf] < 0.5f;
                    glm::vec3 want(column == 0, column == 2, column == 3);
                    if (y > 120) want = glm::vec3(1);
                    faults.wrong += alpha[interval.leaf] > 0.5f && glm::distance(colour[interval.leaf], want) > 0.3f;
                }
                transmittance *= std::exp(-density * (interval.t_exit - interval.t_enter));
                if (transmittance < 0.5) break;
            }
        }
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        const glm::vec3 at = canvas.centres[leaf];
        const bool behind = at.z < kHead.z - 0.1 && at.y > 0.5f;  // leaves within the outline reach this far
        faults.behind += behind && alpha[leaf] > 0;
    }
    return faults;
}

// Everything that the camera sees is painted, whether pixels are smaller than leaves or larger, and whatever the
// performer's transform is. What lies behind the surface is not painted. Colours are those of the image where the
// centre of the leaf is visible.
TEST_F(ToolsTest, ProjectionLeavesNoHolesAndPaintsNothingBehind) {
    const voctree::VOctree tree = figure_tree();
    const edit::Canvas canvas(tree);
    const std::vector<float> sigma = edit::densities(canvas, 0);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::Picker picker(device(), field);
    picker.show(0);
    for (const Standing& standing : standings())
        for (const uint32_t side : {12u, 40u, 200u}) {
            SCOPED_TRACE(fmt::format("{}, {} pixels", standing.name, side));
            const stage::Camera camera =
                render::in_performer(camera_before(standing, side), glm::mat4(standing.world_from_performer));
            const std::vector<voctree::LeafEdit> edits = edit::project(picker, canvas, sigma, columns(side), camera);
            const ProjectionFaults faults = faults_of(tree, canvas, edits, standing, side);
            EXPECT_GT(faults.seen, 150u);
            EXPECT_EQ(faults.holes, 0u);
            EXPECT_LE(faults.wrong, faults.seen / 100) << "beside the borders of columns";
            EXPECT_EQ(faults.behind, 0u) << "behind the head";
        }
    // The comparison fails for another transform.
    const Standing straight = standings()[0];
    Standing other = straight;
    other.world_from_performer[3] += 0.15 * straight.world_from_performer[0];
    const stage::Camera camera =
        render::in_performer(camera_before(straight, 200), glm::mat4(other.world_from_performer));
    const std::vector<voctree::LeafEdit> edits = edit::project(picker, canvas, sigma, columns(200), camera);
    const ProjectionFaults faults = faults_of(tree, canvas, edits, straight, 200);
    EXPECT_GT(faults.holes + faults.wrong, faults.seen / 10);
}

// A pixel of an image in the world picks the leaf that its ray meets, at the point where it meets it.
TEST_F(ToolsTest, PicksWhereThePerformerStands) {
    voctree::VOctree tree = figure_tree();
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    render::Picker picker(device(), field);
    picker.show(0);
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
    for (const Standing& standing : standings()) {
        SCOPED_TRACE(standing.name);
        const stage::Camera camera = camera_before(standing, 60);
        const stage::Camera inside = render::in_performer(camera, glm::mat4(standing.world_from_performer));
        std::vector<PickRay> rays;
        for (uint32_t i = 0; i < 60 * 60; ++i) rays.push_back(render::pick_ray(inside, {i % 60 + 0.5, i / 60 + 0.5}));
        const std::vector<render::Picked> picked = picker.pick(rays);
        uint32_t hits = 0, others = 0;
        double worst_m = 0;
        for (uint32_t i = 0; i < 60 * 60; ++i) {
            const reference::Ray ray = ray_in_performer(camera, i % 60, i / 60, standing.world_from_performer);
            const auto truth = reference::pick(tree, slices, ray, double{render::kPickAlpha});
            hits += truth.has_value();
            if (truth.has_value() != picked[i].hit() || (truth && truth->leaf != picked[i].leaf)) ++others;
            if (truth && picked[i].hit())
                worst_m = std::max(worst_m, std::abs(truth->distance_m - double{picked[i].distance_m}));
        }
        EXPECT_GT(hits, 200u);
        EXPECT_LE(others, hits / 100) << "rays that graze a leaf";
        EXPECT_LE(worst_m, 0.02);
    }
}

TEST_F(ToolsTest, BrushGoesOverTheSurfaceUnderALineOfPixels) {
    const voctree::VOctree tree = figure_tree();
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::Picker picker(device(), field);
    picker.show(0);
    const stage::Camera camera = figure_camera(100);
    const std::vector<glm::dvec2> line = {{2, 40}, {98, 40}};
    const std::vector<edit::Touch> touches = edit::touches_under(picker, camera, line);
    ASSERT_GT(touches.size(), 30u);
    EXPECT_LT(touches.size(), 90u) << "beside the head there is nothing";
    for (const edit::Touch& touch : touches) {
        for (const glm::vec3& point : {touch.front, touch.back}) {
            EXPECT_LT(glm::distance(glm::dvec3(point), kHead), kHeadRadius + 0.02);
            EXPECT_GT(glm::distance(glm::dvec3(point), kHead), kHeadRadius - 0.05);
            EXPECT_GT(point.z, kHead.z - 0.05);
        }
        EXPECT_LE(touch.back.z, touch.front.z);
    }
}

// The share of the alpha gathered by a pixel's ray that comes from painted leaves.
double painted_part(const voctree::VOctree& tree, const stage::Camera& camera, glm::dvec2 pixel,
                    const std::vector<voctree::LeafEdit>& edits) {
    std::set<uint32_t> painted;
    for (const voctree::LeafEdit& edit : edits)
        if (edit.alpha > 0.9f) painted.insert(edit.leaf);
    const PickRay pick = render::pick_ray(camera, pixel);
    reference::Ray ray;
    ray.origin = glm::dvec3(pick.origin);
    ray.direction = glm::dvec3(pick.direction);
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
    double transmittance = 1, part = 0;
    for (const reference::LeafInterval& interval : reference::intersect(tree, ray)) {
        const double through =
            std::exp(-std::max(slices[interval.leaf].sigma, 0.0) * (interval.t_exit - interval.t_enter));
        if (painted.contains(interval.leaf)) part += transmittance * (1 - through);
        transmittance *= through;
    }
    return transmittance < 1 ? part / (1 - transmittance) : 0;
}

// Captured surfaces are soft: a ray reaches an alpha of 0.99 far behind what a pixel shows.
TEST_F(ToolsTest, ADotOfTheBrushIsWhatItsPixelShowsHoweverSoftTheSurface) {
    const stage::Camera camera = figure_camera(100);
    const glm::dvec2 pixel(50.5, 40.5);
    const edit::Brush brush{0.03f, 0.9f, {0, 0, 1}};
    for (const float dense : {1.0f, 0.1f, 0.04f}) {
        SCOPED_TRACE(dense);
        voctree::VOctree tree = figure_tree();
        for (float& entry : tree.sigma_basis) entry *= dense;
        const edit::Canvas canvas(tree);
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
        render::Picker picker(device(), field);
        picker.show(0);
        const std::vector<voctree::LeafEdit> edits =
            edit::stroke(canvas, edit::densities(canvas, 0), brush, edit::touches_under(picker, camera, {&pixel, 1}));
        EXPECT_GT(painted_part(tree, camera, pixel, edits), 0.9);
        EXPECT_EQ(painted_part(tree, camera, pixel + glm::dvec2(0, 12), edits), 0);
    }
}

// Half a leaf apart in each direction, so that each leaf meets eight of the other tree.
TEST(Carry, EditsGoToWhatLiesThereInAnotherTree) {
    const voctree::VOctree tree = figure_tree();
    const edit::Canvas from(tree);
    voctree::VOctree moved = tree;
    const glm::vec3 half =
        0.5f * from.edges_m[0] * moved.box_size / (moved.box_size.x + moved.box_size.y + moved.box_size.z) * 3.0f;
    moved.box_min += half;
    const edit::Canvas to(moved);
    const glm::vec3 centre(kHead);
    const auto radius = static_cast<float>(kHeadRadius);
    std::vector<voctree::LeafEdit> edits;
    for (const uint32_t leaf : edit::all_leaves_in(from, edit::sphere_region(centre, 0.6f * radius)))
        edits.push_back({.leaf = leaf, .colour = {0, 1, 0}, .alpha = leaf % 2 ? 1.0f : 0.5f, .sigma = 7});
    std::set<uint32_t> painted;
    for (const voctree::LeafEdit& edit : edit::carried(from, edits, to)) {
        EXPECT_TRUE(painted.insert(edit.leaf).second);
        const float distance = glm::distance(to.centres[edit.leaf], centre);
        EXPECT_LT(distance, 0.6f * radius + 2 * from.edges_m[0]);
        EXPECT_EQ(edit.colour, glm::vec3(0, 1, 0));
        EXPECT_TRUE(edit.alpha == 1 || edit.alpha == 0.5f);
        if (distance < 0.6f * radius - from.edges_m[0]) {
            EXPECT_EQ(edit.sigma, 7) << "all of it lies in edited leaves";
        }
        if (distance > 0.6f * radius + 0.9f * from.edges_m[0]) {
            EXPECT_EQ(edit.sigma, voctree::kKeepSigma) << "less than half of it";
        }
    }
    for (const uint32_t leaf : edit::all_leaves_in(to, edit::sphere_region(centre, 0.6f * radius - from.edges_m[0])))
        EXPECT_TRUE(painted.contains(leaf)) << leaf;
    EXPECT_TRUE(edit::carried(from, {}, to).empty());
    // To the same tree they come back as they are.
    std::vector<voctree::LeafEdit> same = edit::carried(from, edits, from);
    ASSERT_EQ(same.size(), edits.size());
    for (size_t i = 0; i < same.size(); ++i) EXPECT_EQ(same[i], edits[i]) << i;
}

}  // namespace
}  // namespace neuvv::test

// Far levels: which level a performer is drawn at, that images of far performers come nearer to those of many rays, and
// that what is near or painted is drawn as without levels.
#include "render/volume/field_levels.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "render/frame/frame_renderer.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/waver_tree.h"

namespace neuvv::test {
namespace {

constexpr double kLeafM = 0.03;  // of waver_tree
constexpr uint32_t kSide = 96;   // of images
constexpr uint32_t kTruthSamples = 8;

// The waver before the camera, so far away that neighbouring rays are `rays_m` apart where they meet its box.
stage::Camera camera_at(const render::Field& field, double rays_m) {
    stage::Camera camera = look_at(glm::dvec3(0, 0.96, 5), glm::dvec3(0, 0.96, 0), kSide, kSide);
    camera.world_from_camera[3] = glm::dvec4(0, 0.96, double{field.leaves_max.z} + rays_m * kSide, 1);
    return camera;
}

double squared_error(const media::Image& a, const media::Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(a.rgba[i] - b.rgba[i], 2);
    return sum / static_cast<double>(a.rgba.size());
}

struct FieldLevelsTest : GpuTest {
    media::Image image(const stage::Camera& camera, bool far_levels, uint32_t paint = 0) {
        settings.instances[0].paint = paint;
        settings.far_levels = far_levels;
        return renderer.render(camera, settings);
    }
    FieldLevelsTest() {
        settings.width = settings.height = kSide;
        settings.mode = render::TraceMode::kPlay;
        settings.resolve.background = {1, 1, 1, 1};
    }
    bool builds_slices() const {
        for (const gpu::PassTime& pass : renderer.pass_times())
            if (pass.name.starts_with("slice")) return true;
        return false;
    }

    voctree::VOctree tree = waver_tree();
    render::Field field = render::upload_far_levels(device(), tree);
    render::FrameRenderer renderer{device(), field, {kSide, kSide}};
    render::FrameSettings settings;
};

TEST_F(FieldLevelsTest, LeavesLookNoLargerThanTheDistanceOfRays) {
    ASSERT_EQ(field.coarser.size(), 3u);  // of leaves at depths 5, 4, 3
    EXPECT_LT(field.coarser[0].leaf_count, field.leaf_count / 3);
    EXPECT_LT(field.coarser[1].leaf_count, field.coarser[0].leaf_count / 3);
    const auto level = [&](double rays_m, uint32_t samples = 1) {
        return render::far_level_for(field, std::vector{camera_at(field, rays_m)}, glm::mat4(1), samples);
    };
    for (uint32_t k = 1; k <= 3; ++k) {
        const double edge_m = kLeafM * std::exp2(k);
        EXPECT_EQ(level(0.99 * edge_m), k - 1);
        EXPECT_EQ(level(1.01 * edge_m), k);
        EXPECT_EQ(level(1.01 * edge_m, 2), k - 1) << "more rays a pixel";
    }
    EXPECT_EQ(level(100), 3u);
    EXPECT_EQ(level(-0.001), 0u) << "an eye in the box";
    const stage::Camera near = camera_at(field, 1.1 * kLeafM), far = camera_at(field, 9 * kLeafM);
    EXPECT_EQ(render::far_level_for(field, std::vector{far, near}, glm::mat4(1), 1), 0u)
        << "all eyes see the same level";
    EXPECT_EQ(render::far_level_for(field.coarser[0], std::vector{far}, glm::mat4(1), 1), 0u)
        << "without levels of its own";
}

// Squashed along the direction of view, a performer looks as large as before: so do its cells.
TEST_F(FieldLevelsTest, SquashedPerformersHaveNoCoarserLevel) {
    const auto level = [&](const glm::dmat4& world_from_performer, const stage::Camera& camera) {
        return render::far_level_for(field, std::vector{camera}, glm::mat4(world_from_performer), 1);
    };
    const glm::dmat4 turned = glm::rotate(glm::dmat4(1), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
    for (uint32_t k = 0; k <= 3; ++k) {
        const stage::Camera camera = camera_at(field, 1.01 * kLeafM * std::exp2(k));
        ASSERT_EQ(level(glm::dmat4(1), camera), k);
        for (const double thickness : {0.5, 0.1, 0.01}) {
            const glm::dmat4 squashed = glm::scale(glm::dmat4(1), glm::dvec3(1, 1, thickness));
            EXPECT_LE(level(squashed, camera), k) << thickness;
            // Also where the axes of the camera and of the performer differ.
            stage::Camera other = camera;
            other.world_from_camera = turned * other.world_from_camera;
            EXPECT_LE(level(turned * squashed, other), k) << thickness;
        }
        for (const double size : {0.1, 1.0, 7.0}) {
            stage::Camera other = camera;
            other.world_from_camera[3] = glm::dvec4(size * glm::dvec3(other.world_from_camera[3]), 1);
            other.world_from_camera = turned * other.world_from_camera;
            EXPECT_EQ(level(turned * glm::scale(glm::dmat4(1), glm::dvec3(-size, size, size)), other), k) << size;
        }
    }
}

TEST_F(FieldLevelsTest, ClipsWhoseFramesShareBasesHaveNone) {
    tree.sigma_basis[1] = 0.5f;
    EXPECT_TRUE(render::upload_far_levels(device(), tree).coarser.empty());
}

// Leaves so far apart that the cells of the next two depths contain one each.
TEST_F(FieldLevelsTest, LevelsHaveAtMostHalfOfTheLeavesOfTheLevelBefore) {
    voctree::VOctree scattered = tree;
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < 16 * 16 * 16; ++i)
        positions.push_back({4 * (i % 16), 4 * (i / 16 % 16), 4 * (i / 256), 6});
    voctree::build_topology(scattered, positions);
    const render::Field levels = render::upload_far_levels(device(), scattered);
    ASSERT_EQ(levels.coarser.size(), 1u);
    EXPECT_EQ(levels.coarser[0].leaf_count, levels.leaf_count / 8);
    EXPECT_EQ(levels.coarser[0].finest_level, 3u);
}

// Over several positions of the camera, as one ray a pixel may meet the right leaves by chance.
TEST_F(FieldLevelsTest, FarPerformersComeNearerToManyRays) {
    render::FrameRenderer many(device(), field, {kSide, kSide, kTruthSamples});
    render::FrameSettings truth_settings = settings;
    truth_settings.samples = kTruthSamples;
    truth_settings.far_levels = false;
    for (uint32_t level = 1; level <= 3; ++level) {
        double without = 0, with = 0;
        for (int position = 0; position < 5; ++position) {
            stage::Camera camera = camera_at(field, 1.2 * kLeafM * std::exp2(level));
            camera.world_from_camera[3].x += 0.013 * position;
            const media::Image truth = many.render(camera, truth_settings);
            without += squared_error(truth, image(camera, false));
            with += squared_error(truth, image(camera, true));
            ASSERT_EQ(renderer.plan().drawn.size(), 1u);
            EXPECT_EQ(renderer.plan().drawn[0][0].field, level);
        }
        EXPECT_LT(with, 0.8 * without) << level;
    }
}

// Dynamic resolution follows the time that images take, which must not show in the level.
TEST_F(FieldLevelsTest, FewerRaysThanPixelsDoNotChangeTheLevel) {
    const stage::Camera camera = camera_at(field, 2.2 * kLeafM);
    for (const double scale : {1.0, 0.7, 0.3}) {
        settings.scale = scale;
        image(camera, true);
        ASSERT_EQ(renderer.plan().drawn.size(), 1u);
        EXPECT_EQ(renderer.plan().drawn[0][0].field, 1u) << scale;
    }
}

TEST_F(FieldLevelsTest, NearPerformersAreDrawnAsWithoutLevels) {
    const render::Field alone = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer plain(device(), alone, {kSide, kSide});
    const stage::Camera near = camera_at(field, 1.5 * kLeafM), far = camera_at(field, 5 * kLeafM);
    const media::Image near_truth = plain.render(near, settings), far_truth = plain.render(far, settings);
    EXPECT_EQ(image(near, true).rgba, near_truth.rgba);
    EXPECT_EQ(image(far, false).rgba, far_truth.rgba) << "switched off";
    EXPECT_NE(image(far, true).rgba, far_truth.rgba);
    EXPECT_EQ(image(near, true).rgba, near_truth.rgba) << "with slices of both levels in the cache";
}

TEST_F(FieldLevelsTest, PaintIsDrawnOnTheLeavesThatItRefersTo) {
    voctree::EditLayer layer{voctree::painted_field(tree), {}};
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf += 2) {
        voctree::LeafEdit edit;
        edit.leaf = leaf;
        edit.last = static_cast<float>(tree.frames - 1);
        edit.colour = {1, 0, 0};
        edit.alpha = 1;
        layer.edits.push_back(edit);
    }
    ASSERT_EQ(voctree::defect_of(layer), "");
    const uint32_t paint = renderer.paints().add(std::vector{render::PaintUse{&layer, stage::PaintBlend::kNormal, 1}});
    const stage::Camera far = camera_at(field, 5 * kLeafM);
    const media::Image truth = image(far, false, paint);
    EXPECT_EQ(image(far, true, paint).rgba, truth.rgba);
    EXPECT_NE(truth.rgba, image(far, false).rgba);
}

TEST_F(FieldLevelsTest, SlicesArePrefetchedAtTheLevelThatIsDrawn) {
    const stage::Camera far = camera_at(field, 5 * kLeafM);
    settings.next_instances = {{1}};
    settings.prefetch_parts = render::kSliceParts;
    image(far, true);
    settings.next_instances.clear();
    settings.instances[0].frame = 1;
    image(far, true);
    EXPECT_FALSE(builds_slices());
    image(far, false);
    EXPECT_TRUE(builds_slices()) << "the finest level's was not prefetched";
}

// A far performer and a near one of the same clip, at different times.
TEST_F(FieldLevelsTest, EachInstanceIsPrefetchedAtItsOwnLevel) {
    const stage::Camera camera = camera_at(field, 5 * kLeafM);
    const glm::mat4 near(glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 0.8 * camera.world_from_camera[3].z)));
    settings.instances = {{0}, {1, near}};
    settings.next_instances = {{2}, {3, near}};
    settings.prefetch_parts = 4 * render::kSliceParts;
    renderer.render(camera, settings);
    settings.instances = settings.next_instances;
    settings.next_instances.clear();
    renderer.render(camera, settings);
    ASSERT_EQ(renderer.plan().drawn.size(), 2u);
    EXPECT_EQ(renderer.plan().drawn[0][0].field, 0u);
    EXPECT_EQ(renderer.plan().drawn[1][0].field, 2u);
    EXPECT_FALSE(builds_slices());
    settings.instances = {{2, near}};
    renderer.render(camera, settings);
    EXPECT_TRUE(builds_slices()) << "the far performer's time was not prefetched for the near one";
}

VkResult VKAPI_CALL no_memory(VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*, VkDeviceMemory*) {
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

TEST_F(FieldLevelsTest, WithoutMemoryForLevelsTheFinestLeavesAreDrawn) {
    const stage::Camera far = camera_at(field, 5 * kLeafM);
    render::FrameRenderer one_slice(device(), field, {.width = kSide, .height = kSide, .slice_budget = 1});
    settings.far_levels = false;
    const media::Image finest = one_slice.render(far, settings);
    device().memory_pool().clear(device().handle());
    const PFN_vkAllocateMemory allocate = std::exchange(vkAllocateMemory, &no_memory);
    settings.far_levels = true;
    const media::Image without_memory = one_slice.render(far, settings);
    vkAllocateMemory = allocate;
    EXPECT_EQ(without_memory.rgba, finest.rgba);
    EXPECT_EQ(one_slice.render(far, settings).rgba, finest.rgba) << "images do not switch where there is memory later";
}

TEST_F(FieldLevelsTest, LevelsStayWhereFewerSlicesGiveThemMemory) {
    const stage::Camera far = camera_at(field, 5 * kLeafM);
    const media::Image coarse = image(far, true), finest = image(far, false);
    EXPECT_NE(coarse.rgba, finest.rgba);
    render::FrameRenderer limited(device(), field, {kSide, kSide});
    settings.far_levels = false;
    limited.render(far, settings);
    ASSERT_GT(limited.slices().performer()->slices()->trees().slices, 1u);
    device().memory_pool().clear(device().handle());
    device().limit_memory(device().memory_pool().allocated());
    settings.far_levels = true;
    EXPECT_EQ(limited.render(far, settings).rgba, coarse.rgba);
    device().limit_memory(std::nullopt);
    EXPECT_EQ(limited.plan().drawn[0][0].field, 2u);
}

// A switch of levels then takes memory for a few passes alone, not for slices.
TEST_F(FieldLevelsTest, TheFirstImageMakesThePerformersOfAllLevels) {
    const stage::Camera near = camera_at(field, 1.1 * kLeafM);
    image(near, false);
    const uint64_t without = device().buffer_bytes();
    image(near, true);
    const uint64_t with = device().buffer_bytes();
    for (const double leaves : {2.2, 4.4, 8.8}) {
        image(camera_at(field, leaves * kLeafM), true);
        EXPECT_GT(renderer.plan().drawn[0][0].field, 0u);
    }
    EXPECT_LT(device().buffer_bytes() - with, (with - without) / 4);
}

TEST_F(FieldLevelsTest, OtherFieldsComeAndGoWithTheirLevels) {
    const stage::Camera far = camera_at(field, 5 * kLeafM);
    const media::Image alone = image(far, true);
    const render::Field other = render::upload_far_levels(device(), tree);
    renderer.change_fields({&other, &field});
    settings.instances[0].field = 1;
    EXPECT_EQ(image(far, true).rgba, alone.rgba);
    EXPECT_EQ(renderer.plan().drawn[0][0].field, 2u + 3u + 1u) << "the second level of the second field";
    renderer.change_fields({&field});
    settings.instances[0].field = 0;
    EXPECT_EQ(image(far, true).rgba, alone.rgba);
}

}  // namespace
}  // namespace neuvv::test

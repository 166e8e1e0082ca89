// Images that are submitted without waiting for them.
#include <gtest/gtest.h>

#include "gpu/host_copies.h"
#include "render/frame/frame_renderer.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"

namespace neuvv::test::submit_test {
namespace {

constexpr uint32_t kWidth = 40, kHeight = 32;

using SubmitTest = GpuTest;

// The host goes on while the device draws, and waits for nothing here but the images before the last: what it writes
// for an image must not reach the one before.
TEST_F(SubmitTest, SubmittedImagesAreThoseThatOneWaitsFor) {
    const voctree::VOctree tree = random_tree({.seed = 2, .node_levels = 2, .leaves = 900, .bases = 5});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const render::FrameCapacity capacity{.width = kWidth, .height = kHeight};
    render::FrameRenderer submitted(device(), {&field}, capacity), drawn(device(), {&field}, capacity);
    constexpr uint64_t kBytes = uint64_t{4} * kWidth * kHeight;
    std::vector<stage::Camera> cameras;
    std::vector<render::FrameSettings> all;
    std::vector<std::vector<uint32_t>> expected;
    for (uint32_t i = 0; i < 8; ++i) {
        cameras.push_back(look_at({3.0 - i, 1.0, 2.0 + i}, {0, 0, 0}, kWidth, kHeight));
        std::vector<render::Instance> instances{{0.3f * static_cast<float>(i % 5)}};
        if (i % 3 == 2) {
            instances.push_back(instances[0]);
            instances[1].world_from_performer[3] = {0.3f, 0.1f, 0, 1};
        }
        const auto& settings =
            all.emplace_back(render::FrameSettings{.instances = instances, .width = kWidth, .height = kHeight});
        submitted.draw({&cameras[i], 1}, settings);  // until there is room for all
        gpu::download(device(), drawn.draw({&cameras[i], 1}, settings), expected.emplace_back(kBytes / 4).data(),
                      kBytes);
    }
    std::vector<gpu::Buffer> kept;
    for (size_t i = 0; i < all.size(); ++i) kept.emplace_back(device(), "kept", kBytes, gpu::MemoryKind::kDevice);
    for (size_t i = 0; i < all.size(); ++i)
        submitted.submit({&cameras[i], 1}, all[i], [&to = kept[i]](gpu::Commands& commands, const gpu::Buffer& images) {
            gpu::compute_barrier(commands);
            gpu::copy(commands, images, to, kBytes);
        });
    EXPECT_TRUE(submitted.finish());
    EXPECT_NE(expected[0], expected[1]) << "something is to be seen";
    for (size_t i = 0; i < kept.size(); ++i) {
        std::vector<uint32_t> pixels(kBytes / 4);
        gpu::download(device(), kept[i], pixels.data(), kBytes);
        EXPECT_EQ(pixels, expected[i]) << i;
    }
}

// About half of the leaves live, which are more entries than a slice has room for at first.
TEST_F(SubmitTest, WhatLacksPartsIsFoundAndNextTimeThereIsRoom) {
    const voctree::VOctree tree = random_tree({.seed = 4, .node_levels = 3, .leaves = 30000});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const render::FrameCapacity capacity{.width = kWidth, .height = kHeight};
    render::FrameRenderer submitted(device(), {&field}, capacity), drawn(device(), {&field}, capacity);
    const stage::Camera camera = look_at({2.0, 1.0, 2.0}, {0, 0, 0}, kWidth, kHeight);
    const render::FrameSettings settings{.width = kWidth, .height = kHeight};
    std::vector<uint32_t> expected(kWidth * kHeight), pixels(expected.size());
    const uint64_t bytes = expected.size() * sizeof(uint32_t);
    gpu::download(device(), drawn.draw({&camera, 1}, settings), expected.data(), bytes);
    const gpu::Buffer kept(device(), "kept", bytes, gpu::MemoryKind::kDevice);
    const auto submit = [&] {
        submitted.submit({&camera, 1}, settings, [&](gpu::Commands& commands, const gpu::Buffer& images) {
            gpu::compute_barrier(commands);
            gpu::copy(commands, images, kept, bytes);
        });
    };
    submit();
    EXPECT_FALSE(submitted.finish()) << "there was room at once";
    submitted.forget_slices();
    for (int i = 0; i < 6; ++i) submit();
    EXPECT_TRUE(submitted.finish());
    gpu::download(device(), kept, pixels.data(), bytes);
    EXPECT_EQ(pixels, expected);
}

// The image after the next has the room, without finish().
TEST_F(SubmitTest, ImagesThatLackPartsMakeRoomForLaterOnes) {
    const voctree::VOctree tree = random_tree({.seed = 4, .node_levels = 3, .leaves = 30000});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer frames(device(), {&field}, {.width = kWidth, .height = kHeight});
    const stage::Camera camera = look_at({2.0, 1.0, 2.0}, {0, 0, 0}, kWidth, kHeight);
    for (int i = 0; i < 4; ++i) frames.submit({&camera, 1}, {.width = kWidth, .height = kHeight});
    EXPECT_TRUE(frames.finish());
}

}  // namespace
}  // namespace neuvv::test::submit_test

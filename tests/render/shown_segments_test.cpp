// Which segments of a clip are read, and which stay on the device.
#include "render/clips/shown_segments.h"
#include "render/clips/uploaded_segment.h"

#include <gtest/gtest.h>

#include "support/gpu_test.h"
#include "support/random_tree.h"
#include "support/segmented_copy.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

struct ShownSegmentsTest : GpuTest {
    TemporaryFolder folder;
    voctree::ClipIndex clip;
    std::vector<uint32_t> read;                // the segments, as they were read
    std::vector<const render::Field*> fields;  // what a renderer would have
    size_t changes = 0;
    uint64_t field_bytes = 0;

    void SetUp() override {
        const std::string path = (folder.path / "clip.nvv").string();
        write_segmented_copy(random_tree({.node_levels = 2, .leaves = 200, .bases = 2, .frames = 8}), {2, 2, 2, 2},
                             path);
        clip = voctree::read_clip_index(path);
        const render::Field field =
            render::upload_field(device(), voctree::read_nvv(clip.segments[0].file), render::WeightPrecision::kHalf);
        field_bytes = render::device_bytes(field);
        EXPECT_GT(field_bytes, field.whole_weights().bytes);
    }
    render::ShownSegments keeping(uint64_t bytes) {
        return render::ShownSegments(
            clip,
            [this](const voctree::ClipSegment& file, uint32_t segment) {
                read.push_back(segment);
                return render::upload_segment(device(), file, render::FarLevels::kNo).field;
            },
            bytes);
    }
    // The frames are shown one after the other, each in the middle of a segment.
    void show(render::ShownSegments& shown, std::initializer_list<uint32_t> segments) {
        for (const uint32_t segment : segments) {
            const auto instances =
                shown.show(voctree::segment_shares(clip, 2.0 * segment + 0.5), [this](const auto& now) {
                    fields = now;
                    ++changes;
                });
            ASSERT_EQ(instances.size(), 1u);
            ASSERT_LT(instances[0].field, fields.size());
            EXPECT_EQ(shown.segment_of(instances[0].field), segment);
            EXPECT_GT(fields[instances[0].field]->leaf_count, 0u) << "it exists";
        }
    }
};

TEST_F(ShownSegmentsTest, WithoutRoomEachIsReadAgain) {
    render::ShownSegments shown = keeping(0);
    show(shown, {0, 0, 1, 0});
    EXPECT_EQ(read, (std::vector<uint32_t>{0, 1, 0}));
    EXPECT_EQ(changes, 3u);
    EXPECT_FALSE(shown.holds(1));
}

TEST_F(ShownSegmentsTest, WhatHasRoomIsReadOnce) {
    render::ShownSegments shown = keeping(UINT64_MAX);
    show(shown, {0, 1, 2, 3, 0, 1, 2, 3, 3});
    EXPECT_EQ(read, (std::vector<uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(changes, 8u);
    EXPECT_EQ(fields.size(), 1u) << "a renderer has those that are shown";
}

TEST_F(ShownSegmentsTest, ThoseThatWereShownLastStay) {
    render::ShownSegments shown = keeping(field_bytes + field_bytes / 2);  // one beside the one that is shown
    show(shown, {0, 1, 0, 2, 0});
    EXPECT_EQ(read, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_TRUE(shown.holds(2));
    EXPECT_FALSE(shown.holds(1));
    show(shown, {1});
    EXPECT_EQ(read.back(), 1u);
}

// Where the device has no memory for another one, those that are only kept are given up.
TEST_F(ShownSegmentsTest, MemoryThatIsNeededIsGivenUp) {
    bool is_full = false;
    size_t refused = 0;
    render::ShownSegments shown(
        clip,
        [&](const voctree::ClipSegment& file, uint32_t segment) {
            read.push_back(segment);
            if (std::exchange(is_full, false)) {
                ++refused;
                throw gpu::VulkanError(VK_ERROR_OUT_OF_DEVICE_MEMORY, "a field");
            }
            return render::upload_segment(device(), file, render::FarLevels::kNo).field;
        },
        UINT64_MAX);
    show(shown, {0, 1, 2});
    is_full = true;
    show(shown, {3});
    EXPECT_EQ(refused, 1u);
    EXPECT_TRUE(shown.holds(3));
    EXPECT_FALSE(shown.holds(0));
    EXPECT_FALSE(shown.holds(1));
    show(shown, {0});
    EXPECT_EQ(read, (std::vector<uint32_t>{0, 1, 2, 3, 3, 0}));
}

}  // namespace
}  // namespace neuvv::test

// What sources of segments say: of .nvv files and of streams. plenoctree_forms_test.cpp has PlenOctrees.
#include "voctree/kinds/clip_source.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "stream/transport/nvs_writer.h"
#include "support/input_error.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/coarse.h"
#include "voctree/files/clip.h"
#include "voctree/files/occupied_box.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

struct KindsTest : testing::Test {
    TemporaryFolder folder;
    const voctree::VOctree tree = random_tree({.leaves = 300, .hh_degree = 1});

    voctree::ClipSegment nvv(const char* name) const {
        const std::filesystem::path file = folder.path / name;
        voctree::write_nvv(file, tree, {}, 1, voctree::cut_tree(tree, 2));
        return voctree::read_clip_index(file).segments[0];
    }
    // Of one frame, in which every second leaf has no opacity.
    voctree::ClipSegment stream(const char* name) const {
        stream::QuantisedSlice slice = slice::quantised(voctree::slice_of(tree, 0));
        for (size_t i = 0; i < slice.leaves.size(); i += 2) slice.planes[stream::kOpacityPlane][i] = 0;
        stream::Steps steps;
        steps.fill(1);
        stream::QuantisedSlice decoded;
        stream::Writer writer(folder.path / name, 25, 1, 1);
        stream::Group group;
        group.format = {slice.depth, slice.degree, static_cast<uint32_t>(slice.leaves.size())};
        group.box_min = {tree.box_min.x, tree.box_min.y, tree.box_min.z};
        group.box_size = {tree.box_size.x, tree.box_size.y, tree.box_size.z};
        writer.add(group, {stream::encode(slice, steps, {}, decoded)});
        writer.finish();
        return voctree::read_clip_index(folder.path / name).segments[0];
    }
};

voctree::SegmentContent content_of(const voctree::ClipSegment& segment) {
    return segment.source->content(segment, stream::kShFine, voctree::PlenoctreeColours::kLinear);
}

TEST_F(KindsTest, ANvvHoldsATree) {
    const voctree::ClipSegment segment = nvv("a.nvv");
    const voctree::ClipSource& source = *segment.source;
    EXPECT_EQ(source.header(segment).leaf_count, tree.leaf_count);
    EXPECT_FALSE(source.plays_by_frame());
    EXPECT_FALSE(source.has_server());
    EXPECT_FALSE(source.bytes_per_s());
    source.expect_paintable();
    const voctree::SegmentContent content = content_of(segment);
    ASSERT_TRUE(std::holds_alternative<voctree::VOctree>(content));
    EXPECT_EQ(voctree::slice_at(content, 1.5).leaves.size(), voctree::slice_of(tree, 1.5).leaves.size());
    const voctree::ClipSource::Box box = source.box(segment);
    EXPECT_TRUE(box.has_leaves);
    EXPECT_TRUE(glm::all(glm::lessThanEqual(box.low, voctree::occupied_box(tree).first)));
}

TEST_F(KindsTest, ADamagedOrOtherNvvHasNoCoarseTree) {
    voctree::ClipSegment segment = nvv("a.nvv");
    ASSERT_TRUE(segment.source->coarse(segment));
    segment.frames += 1;
    EXPECT_FALSE(segment.source->coarse(segment));
    expect_input_error([&] { content_of(segment); }, {"a.nvv", "its clip says"});
    segment.frames -= 1;
    std::filesystem::resize_file(segment.file, 100);
    EXPECT_FALSE(segment.source->coarse(segment));
    expect_input_error([&] { segment.source->box(segment); }, {"a.nvv"});
}

TEST_F(KindsTest, AStreamHoldsSlices) {
    const voctree::ClipSegment segment = stream("a.nvs");
    const voctree::ClipSource& source = *segment.source;
    EXPECT_TRUE(source.stands_alone(segment));
    EXPECT_FALSE(source.coarse(segment));
    EXPECT_FALSE(source.has_server());
    expect_input_error([&] { source.expect_paintable(); }, {"a.nvs", "cannot be painted"});
    const voctree::SegmentContent content = content_of(segment);
    ASSERT_TRUE(std::holds_alternative<voctree::FrameSlice>(content));
    const stream::QuantisedSlice& whole = *std::get<voctree::FrameSlice>(content).slice;
    const size_t leaves = whole.leaves.size();
    const auto clear = std::ranges::count(whole.planes[stream::kOpacityPlane], 0);
    ASSERT_GT(clear, 10);
    const slice::Slice shown = voctree::slice_at(content, 0);
    EXPECT_EQ(slice::defect_of(shown), "");
    EXPECT_EQ(shown.leaves.size(), leaves - static_cast<size_t>(clear));
    EXPECT_EQ(source.plays_by_frame()->leaves, leaves);
    EXPECT_EQ(source.plays_by_frame()->degree, 1u);
    EXPECT_TRUE(source.box(segment).has_leaves);
}

}  // namespace
}  // namespace neuvv::test

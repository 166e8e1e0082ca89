// The edits of painting operations on selected leaves: the same as those of edit/, at the frames of the operation.
#include "editor/paint/paint_operation.h"

#include <gtest/gtest.h>

#include <set>

#include "support/figure.h"
#include "support/waver_tree.h"

namespace neuvv::test {
namespace {

using Kind = editor::PaintOperation::Kind;

std::set<uint32_t> leaves_of(const voctree::EditLayer& layer) {
    std::set<uint32_t> leaves;
    for (const voctree::LeafEdit& edit : layer.edits) leaves.insert(edit.leaf);
    return leaves;
}

bool holds_at(const voctree::EditLayer& layer, uint32_t leaf, float frame) {
    for (const voctree::LeafEdit& edit : layer.edits)
        if (edit.leaf == leaf && edit.first <= frame && frame <= edit.last) return true;
    return false;
}

struct PaintWorks : testing::Test {
    voctree::VOctree tree = waver_tree();
    edit::Canvas canvas{tree};
    voctree::EditLayer empty{voctree::painted_field(tree), {}};
    edit::Region chest = edit::sphere_region({0, 1.2f, 0}, 0.15f),
                 hand_somewhere = edit::box_region({0.3f, 0.5f, -1}, {1, 2, 1});

    std::shared_ptr<const voctree::EditLayer> in(const edit::Region& region, const editor::PaintOperation& operation,
                                                 const voctree::EditLayer& before) const {
        return editor::apply_operation(canvas, before, editor::leaves_for(canvas, before, region, operation),
                                       operation);
    }
};

TEST_F(PaintWorks, ColourByShareAndEraseFromAHalfOn) {
    const std::vector<editor::SelectedLeaf> selected = {{3, 1}, {5, 0.49f}, {8, 0.5f}};
    editor::PaintOperation operation{.colour = {0, 0, 1}, .opacity = 0.5f, .frames = {2, 4}};
    const auto painted = editor::apply_operation(canvas, empty, selected, operation);
    ASSERT_TRUE(painted);
    const std::vector<voctree::LeafEdit> want = {
        {3, 2, 4, {0, 0, 1}, 0.5f}, {5, 2, 4, {0, 0, 1}, 0.245f}, {8, 2, 4, {0, 0, 1}, 0.25f}};
    EXPECT_EQ(painted->edits, want);
    operation.kind = Kind::kErase;
    const auto erased = editor::apply_operation(canvas, *painted, selected, operation);
    ASSERT_TRUE(erased);
    ASSERT_EQ(erased->edits.size(), 3u);
    EXPECT_EQ(erased->edits[0].sigma, 0);
    EXPECT_EQ(erased->edits[0].alpha, 0.5f) << "the colour below stays";
    EXPECT_EQ(erased->edits[1].sigma, voctree::kKeepSigma);
    EXPECT_EQ(erased->edits[2].sigma, 0);
    EXPECT_FALSE(editor::apply_operation(canvas, empty, std::vector<editor::SelectedLeaf>{{5, 0.49f}}, operation))
        << "nothing was done";
    EXPECT_TRUE(empty.edits.empty());
}

TEST_F(PaintWorks, RestoreWhatWasPaintedAndNothingElse) {
    for (const edit::Follow follow : {edit::Follow::kNot, edit::Follow::kRun, edit::Follow::kAll}) {
        editor::PaintOperation operation{.frames = {3, 3, follow}};
        const auto chest_painted = in(chest, operation, empty), painted = in(hand_somewhere, operation, *chest_painted);
        ASSERT_GT(painted->edits.size(), chest_painted->edits.size());
        operation.kind = Kind::kRestore;
        const auto restored = in(hand_somewhere, operation, *painted);
        ASSERT_TRUE(restored);
        EXPECT_EQ(restored->edits, chest_painted->edits);
        EXPECT_EQ(voctree::defect_of(*restored), "");
    }
    // Outside the restored range of frames the edits stay.
    editor::PaintOperation operation{.frames = {1, 6}};
    const auto painted = in(chest, operation, empty);
    operation.kind = Kind::kRestore;
    operation.frames = {3, 3};
    const auto restored = in(chest, operation, *painted);
    EXPECT_EQ(leaves_of(*restored), leaves_of(*painted));
    for (const uint32_t leaf : leaves_of(*painted)) {
        EXPECT_TRUE(holds_at(*restored, leaf, 2) && holds_at(*restored, leaf, 4));
        EXPECT_FALSE(holds_at(*restored, leaf, 3));
    }
    EXPECT_FALSE(in(chest, operation, empty)) << "there is nothing to take out";
}

TEST_F(PaintWorks, ShiftedColoursFollowTheSurface) {
    editor::PaintOperation operation{
        .kind = Kind::kShift, .opacity = 0.75f, .shift = {120, 1}, .frames = {2, 2, edit::Follow::kNot}};
    const auto now = in(hand_somewhere, operation, empty);
    ASSERT_TRUE(now);
    for (const voctree::LeafEdit& edit : now->edits) {
        EXPECT_EQ(edit.first, 2);
        EXPECT_EQ(edit.last, 2);
        EXPECT_FLOAT_EQ(edit.alpha, 0.75f);
        const glm::vec3 want =
            edit::shifted(edit::mean_colour(tree, voctree::RowsAtTime(tree, 2), edit.leaf), operation.shift);
        EXPECT_LT(glm::distance(edit.colour, want), 1e-5f);
    }
    operation.frames.follow = edit::Follow::kAll;
    const auto always = in(hand_somewhere, operation, empty);
    EXPECT_EQ(leaves_of(*always), leaves_of(*now));
    EXPECT_EQ(voctree::defect_of(*always), "");
    size_t longer = 0;
    for (const uint32_t leaf : leaves_of(*now))
        for (uint32_t frame = 0; frame < tree.frames; ++frame) {
            const bool there = edit::density(tree, voctree::RowsAtTime(tree, frame), leaf) > 0;
            EXPECT_EQ(holds_at(*always, leaf, static_cast<float>(frame)), there);
            longer += there;
        }
    EXPECT_GT(longer, leaves_of(*now).size()) << "the arm's root is there for longer";
}

TEST_F(PaintWorks, ChooseWhatIsThereAtTheFrames) {
    const editor::PaintOperation first{.frames = {0, 0}}, all{.frames = {0, 7}};
    const auto before = editor::leaves_for(canvas, empty, hand_somewhere, first);
    const auto ever = editor::leaves_for(canvas, empty, hand_somewhere, all);
    EXPECT_LT(before.size(), ever.size()) << "the hand comes by";
    const std::vector<uint32_t> want = edit::leaves_in(canvas, hand_somewhere, 0, 7);
    ASSERT_EQ(ever.size(), want.size());
    for (size_t i = 0; i < want.size(); ++i) EXPECT_EQ(ever[i].leaf, want[i]);
}

}  // namespace
}  // namespace neuvv::test

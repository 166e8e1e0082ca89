// Painting in the air: which leaves a stroke touches, and that no stroke is lost or stuck, whatever hands and files do.
#include <set>

#include "edit/paint_layers.h"
#include "edit/select.h"
#include "gpu/device.h"
#include "headset/brush_in_hand.h"
#include "headset/hands_at_a_stage.h"
#include "support/segmented_copy.h"
#include "tools/headset/hands/hand_painter.h"

namespace neuvv::test {
namespace {

TEST_F(BrushHandTest, ADabPaintsTheLeavesInItsBallAndIsOneStep) {
    dab(head_of_ben);
    settle();
    const std::set<uint32_t> want = within({head_of_ben}, state.brush.radius_m);
    ASSERT_GT(want.size(), 10u);
    EXPECT_EQ(painted(), want);
    EXPECT_EQ(undo_all(), 1u);
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(BrushHandTest, ADabThatIsOverBeforeTheClipWasReadIsLaidAllTheSame) {
    // The whole press is over before the clip has been read.
    dab(head_of_ben);
    EXPECT_TRUE(interaction.painter.is_busy());
    EXPECT_TRUE(state.editor.document().paint.empty());
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
}

TEST_F(BrushHandTest, StrokesThatFollowEachOtherAreEachAStep) {
    dab(head_of_ben);
    dab(head_of_ben + off);
    dab(head_of_ben - off);
    settle();
    EXPECT_EQ(painted(), within({head_of_ben, head_of_ben + off, head_of_ben - off}, state.brush.radius_m));
    state.editor.undo();
    EXPECT_EQ(painted(), within({head_of_ben, head_of_ben + off}, state.brush.radius_m));
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(BrushHandTest, WhatWasUndoneDoesNotComeBackWithTheNextStroke) {
    dab(head_of_ben);
    settle();
    state.editor.undo();
    EXPECT_FALSE(state.editor.modified());
    dab(head_of_ben + off);
    settle();
    const auto layers = edit::paint_layers_of(state.editor.file(), node("ben"));
    ASSERT_EQ(layers->size(), 1u);
    std::set<uint32_t> leaves;
    for (const voctree::LeafEdit& edit : state.editor.document().paint.at(layers->front().path)->edits)
        leaves.insert(edit.leaf);
    EXPECT_EQ(leaves, within({head_of_ben + off}, state.brush.radius_m));
}

TEST_F(BrushHandTest, AHandThatHoldsPutsDownWhereTheOtherTakesTheBrush) {
    state.tool = headset::HandTool::kArrange;
    const glm::dvec3 before = position("ben");
    point(xr::kLeft, kLeftHand, kBen);
    inputs[xr::kLeft].grab = 1;
    frames(2);
    point(xr::kLeft, kLeftHand + glm::dvec3(0.3, 0, 0), kBen + glm::dvec3(0.3, 0, 0));
    frame();
    state.tool = headset::HandTool::kPaint;  // as the panel does it
    frames(2);
    EXPECT_FALSE(interaction.grab.is_active());
    dab(head_of_ben + glm::dvec3(0.3, 0, 0));
    inputs[xr::kLeft].grab = 0;
    settle();
    EXPECT_LT(glm::distance(position("ben"), before + glm::dvec3(0.3, 0, 0)), 1e-9);
    EXPECT_EQ(undo_all(), 2u) << "a move and a stroke";
}

TEST_F(BrushHandTest, APressInTheFrameOfAnEditIsAStroke) {
    settle();
    tip_at(head_of_ben);
    inputs[xr::kRight].select = 1;
    inputs[xr::kLeft].undo = true;
    state.editor.edit(
        [&](edit::Document& document) { return edit::rename_node(document.file, node("anna"), "berta"); });
    frame();
    inputs[xr::kRight].select = 0;
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
    EXPECT_EQ(state.stage->performers[0].name, "anna") << "it was undone";
}

TEST_F(BrushHandTest, AStrokeCoversItsWayHoweverFewFramesItHas) {
    tip_at(head_of_ben - glm::dvec3(0.3, 0, 0));
    inputs[xr::kRight].select = 1;
    frame();
    tip_at(head_of_ben + glm::dvec3(0.3, 0, 0));
    frame();
    inputs[xr::kRight].select = 0;
    settle();
    std::vector<glm::dvec3> path;
    for (int i = 0; i <= 600; ++i) path.push_back(head_of_ben + glm::dvec3(-0.3 + 0.001 * i, 0, 0));
    EXPECT_EQ(painted(), within(path, state.brush.radius_m));
    EXPECT_EQ(undo_all(), 1u);
}

TEST_F(BrushHandTest, UndoDuringAStrokeEndsItAndIsRefusedUntilItIsLaid) {
    tip_at(head_of_ben);
    inputs[xr::kRight].select = 1;
    frame();
    inputs[xr::kLeft].undo = true;
    frame();
    EXPECT_TRUE(was_notified("still being laid"));
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
    inputs[xr::kLeft].undo = true;
    frame();
    EXPECT_FALSE(state.editor.modified());
}

TEST_F(BrushHandTest, AStrokeBelongsToThePerformerItWasBegunOn) {
    dab(head_of_ben);
    state.tool = headset::HandTool::kArrange;
    select(kAnna);
    state.tool = headset::HandTool::kPaint;
    settle();
    ASSERT_EQ(state.editor.document().paint.size(), 1u);
    const auto layers = edit::paint_layers_of(state.editor.file(), node("ben"));
    ASSERT_TRUE(layers);
    EXPECT_EQ(layers->size(), 1u);
    EXPECT_TRUE(edit::paint_layers_of(state.editor.file(), node("anna"))->empty());
}

TEST_F(BrushHandTest, AClipThatCannotBeReadIsReportedAndNothingIsStuck) {
    damage(clip);
    dab(head_of_ben);
    settle();
    EXPECT_TRUE(was_notified("figure.nvv"));
    EXPECT_FALSE(interaction.painter.is_busy());
    EXPECT_NE(interaction.painter.status().find("figure.nvv"), std::string::npos) << "as long as it is to be painted";
    EXPECT_FALSE(state.editor.modified());
    inputs[xr::kRight].duplicate = true;
    frames(2);
    EXPECT_EQ(state.stage->performers.size(), 3u) << "other edits go on";
}

TEST_F(BrushHandTest, AnotherPerformerIsPaintedAllTheSame) {
    const std::filesystem::path copy = folder.path / "copy.nvv";
    std::filesystem::copy_file(clip, copy);
    edit::PerformerEdit edit;
    edit.clip = copy;
    state.editor.edit([&](edit::Document& document) { return edit::set_performer(document.file, node("anna"), edit); });
    state.tool = headset::HandTool::kArrange;  // so that ben's clip is not read yet
    frames(2);
    damage(copy);
    select(kAnna);
    state.tool = headset::HandTool::kPaint;
    dab(kAnna);
    settle();
    EXPECT_TRUE(was_notified("copy.nvv"));
    state.tool = headset::HandTool::kArrange;
    select(kBen);
    state.tool = headset::HandTool::kPaint;
    dab(head_of_ben);
    settle();
    EXPECT_EQ(painted(), within({head_of_ben}, state.brush.radius_m));
}

TEST_F(BrushHandTest, AClipInSegmentsIsPaintedInTheOthersToo) {
    const std::filesystem::path parts = folder.path / "parts.nvv";
    write_segmented_copy(figure_tree(), {1, 1}, parts);
    edit::PerformerEdit edit;
    edit.clip = parts;
    state.editor.edit([&](edit::Document& document) { return edit::set_performer(document.file, node("ben"), edit); });
    state.brush.whole_clip = true;
    frames(2);
    dab(head_of_ben);
    settle();
    const auto layers = edit::paint_layers_of(state.editor.file(), node("ben"));
    ASSERT_EQ(layers->size(), 1u);
    const auto files = voctree::files_of_layer(state.editor.document().paint, layers->front().path);
    ASSERT_EQ(files.size(), 2u);
    const glm::dmat4 performer_from_world = glm::inverse(state.evaluated.performers[1].world_from_performer);
    const glm::vec3 centre(performer_from_world * glm::dvec4(head_of_ben, 1));
    uint32_t number = 0;
    for (const auto& [file, layer] : files) {
        const voctree::VOctree tree = voctree::read_nvv(parts / voctree::segment_file_name(number));
        const edit::Canvas canvas(tree);
        EXPECT_EQ(layer->field, voctree::painted_field(tree));
        std::set<uint32_t> painted, near;
        for (const voctree::LeafEdit& one : layer->edits) painted.insert(one.leaf);
        for (const uint32_t leaf :
             edit::leaves_in(canvas, edit::sphere_region(centre, static_cast<float>(state.brush.radius_m / 1.6)), 0, 0))
            near.insert(leaf);
        ASSERT_GT(painted.size(), 10u) << number;
        // What was not there at the time of the stroke is not painted.
        EXPECT_TRUE(std::includes(near.begin(), near.end(), painted.begin(), painted.end())) << number;
        EXPECT_TRUE(number > 0 || painted == near) << "all of the segment that was seen";
        ++number;
    }
    EXPECT_EQ(undo_all(), 3u) << "another clip, a stroke, and the same in the other segment";
}

TEST_F(BrushHandTest, ErasingTakesDensityAndKeepsToThisFrameWhereItIsAsked) {
    state.brush.mode = headset::HandBrush::Mode::kErase;
    state.brush.whole_clip = false;
    state.clock.scrub(state.clock.last_s());
    dab(head_of_ben);
    settle();
    ASSERT_EQ(state.editor.document().paint.size(), 1u);
    for (const auto& [path, layer] : state.editor.document().paint) {
        ASSERT_FALSE(layer->edits.empty());
        for (const voctree::LeafEdit& edit : layer->edits) {
            EXPECT_EQ(edit.sigma, 0);
            EXPECT_LE(edit.first, 1);
            EXPECT_GE(edit.last, 1);
        }
    }
}

TEST_F(BrushHandTest, ARegionIsColouredAndForgottenWhereNodesChange) {
    state.tool = headset::HandTool::kRegion;
    settle();  // reads the clip
    tip_at(head_of_ben - glm::dvec3(0.1));
    inputs[xr::kRight].select = 1;
    frame();
    tip_at(head_of_ben + glm::dvec3(0.1));
    frame();
    inputs[xr::kRight].select = 0;
    frame();
    ASSERT_TRUE(interaction.painter.region());
    EXPECT_LT(glm::distance(interaction.painter.region()->low, kHead - glm::dvec3(0.1 / 1.6)), 1e-6);
    interaction.painter.apply_region(state);
    settle();
    EXPECT_GT(painted().size(), 10u);
    ASSERT_TRUE(interaction.painter.region()) << "it can be used again";
    inputs[xr::kRight].duplicate = true;
    frames(3);
    EXPECT_FALSE(interaction.painter.region()) << "numbers of nodes mean others now";
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(BrushHandTest, ABoxOfNothingIsTold) {
    state.tool = headset::HandTool::kRegion;
    settle();
    tip_at(glm::dvec3(0.05, 1.55, -2.75));
    inputs[xr::kRight].select = 1;
    frame();
    tip_at(glm::dvec3(0.06, 1.56, -2.74));
    frame();
    inputs[xr::kRight].select = 0;
    frame();
    interaction.painter.apply_region(state);
    settle();
    EXPECT_TRUE(was_notified("nothing in the box"));
    EXPECT_FALSE(state.editor.modified());
    EXPECT_FALSE(interaction.painter.is_busy());
}

TEST_F(BrushHandTest, ItSaysWhatItPaintsOn) {
    settle();
    frame();
    EXPECT_EQ(interaction.painter.status(), "Paints ben, on a new layer");
    dab(head_of_ben);
    settle();
    frame();
    EXPECT_EQ(interaction.painter.status(), "Paints ben, on its layer \"headset\"");
}

TEST_F(BrushHandTest, NobodyIsPaintedWhereItIsNotKnownWho) {
    state.tool = headset::HandTool::kArrange;
    select({0, 5, -2});
    state.tool = headset::HandTool::kPaint;
    dab(head_of_ben);
    EXPECT_FALSE(interaction.painter.is_busy());
    EXPECT_NE(interaction.painter.status().find("Select"), std::string::npos);
}

}  // namespace
}  // namespace neuvv::test

// Painting the other segments of a clip by jobs: what is painted, as how many steps, and what may happen in between.
#include "editor/paint/paint_spread.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "edit/paint_layers.h"
#include "support/random_tree.h"
#include "support/segmented_copy.h"
#include "support/stage_on_disk.h"
#include "support/temporary_folder.h"
#include "voctree/files/clip.h"

namespace neuvv::test {
namespace {

using editor::Layer;

// A clip of three segments of two frames on a stage; the one in the middle is seen.
struct PaintSpreadTest : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path clip = folder.path / "long.nvv", look;
    editor::Editor editor;
    std::vector<std::string> problems;
    JobQueue jobs{[this](const std::string& problem) { problems.push_back(problem); }, [] {}};
    editor::PaintSpreads spreads{editor, jobs};
    editor::PaintPlace place;
    uint32_t anna = 0;
    editor::PaintOperation operation{.colour = {1, 0, 0}, .frames = {0, 5, edit::Follow::kNot}};
    edit::Region box = edit::box_region(glm::vec3(-9), glm::vec3(0.2f, 9, 9));

    void SetUp() override {
        voctree::VOctree tree = random_tree({.leaves = 300, .bases = 6, .frames = 6});
        write_segmented_copy(tree, {2, 2, 2}, clip);
        const std::filesystem::path show = folder.path / "show.gltf";
        write_stage(show, clip, "anna");
        edit::Document document;
        document.file = stage::read_stage_file(show);
        anna = edit::find_node(document.file, "anna");
        look = edit::free_paint_path(document, anna);
        editor.open(document, false);
        place = editor::PaintPlace(std::make_shared<const voctree::ClipIndex>(voctree::read_clip_index(clip)), 2);
        ASSERT_EQ(place.segment_index, 1u);
    }
    ~PaintSpreadTest() override { jobs.stop(); }

    std::shared_ptr<const editor::PaintClip> segment(uint32_t segment_index) const {
        return std::make_shared<const editor::PaintClip>(voctree::read_segment(place.index->segments[segment_index]));
    }
    std::filesystem::path file(uint32_t segment_index) const {
        return voctree::paint_file(look, place.index->segments[segment_index]);
    }
    static Layer empty(const editor::PaintClip& of) {
        return std::make_shared<const voctree::EditLayer>(voctree::EditLayer{of.field, {}});
    }
    bool set(uint32_t segment_index, const Layer& layer) {
        return editor.edit([&](edit::Document& document) {
            return edit::set_paint(document, anna, look, "look", {{file(segment_index), layer}}, "painted");
        });
    }
    // Paints the segment that is seen, and begins to paint the others.
    void paint() {
        const auto seen = segment(1);
        const editor::PaintedRegion painted = editor::paint_region(place, seen, empty(*seen), operation, box);
        ASSERT_TRUE(painted.layer && painted.spread);
        ASSERT_TRUE(set(1, painted.layer));
        spreads.start(place, anna, look, empty(*seen), painted.layer, *painted.spread);
    }
    void settle() {
        const auto from = std::chrono::steady_clock::now();
        while (!spreads.is_idle()) {
            jobs.run_posted();
            spreads.update(true);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            ASSERT_LT(std::chrono::steady_clock::now() - from, std::chrono::seconds(60));
        }
        EXPECT_TRUE(problems.empty());
    }
    // Waits until all segments are painted but for the edit, which somebody who paints holds up.
    void hold() {
        const auto from = std::chrono::steady_clock::now();
        do {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            ASSERT_LT(std::chrono::steady_clock::now() - from, std::chrono::seconds(60));
            jobs.run_posted();
            spreads.update(false);
        } while (!jobs.idle() || jobs.has_posted());
    }
    std::vector<voctree::LeafEdit> edits_of(uint32_t segment_index) const {
        const auto found = editor.document().paint.find(file(segment_index));
        return found != editor.document().paint.end() ? found->second->edits : std::vector<voctree::LeafEdit>();
    }
    // Paint on a leaf of the last segment that is not in the box.
    Layer green_dot() const {
        const auto last = segment(2);
        uint32_t leaf = 0;
        while (leaf + 1 < last->tree.leaf_count && box(last->canvas.centres[leaf])) ++leaf;
        EXPECT_FALSE(box(last->canvas.centres[leaf]));
        return std::make_shared<const voctree::EditLayer>(
            voctree::EditLayer{last->field, {{.leaf = leaf, .first = 0, .last = 1, .colour = {0, 1, 0}, .alpha = 1}}});
    }
    bool was_notified(const std::string& part) {
        for (const editor::Notice& notice : editor.take_notices())
            if (notice.text.find(part) != std::string::npos) return true;
        return false;
    }
};

TEST_F(PaintSpreadTest, EachSegmentHasLeavesOfItsOwnInARegion) {
    operation.frames = {0, 4, edit::Follow::kNot};
    paint();
    settle();
    for (uint32_t segment_index = 0; segment_index < 3; ++segment_index) {
        const auto of = segment(segment_index);
        editor::PaintOperation there = operation;
        there.frames = {0, segment_index == 2 ? 0.0f : 1.0f, edit::Follow::kNot};
        const Layer want = editor::apply_operation(of->canvas, *empty(*of),
                                                   editor::leaves_for(of->canvas, *empty(*of), box, there), there);
        ASSERT_TRUE(want) << segment_index;
        EXPECT_EQ(edits_of(segment_index), want->edits) << segment_index;
    }
    editor.undo();
    EXPECT_TRUE(edits_of(0).empty() && edits_of(2).empty()) << "the others are one step";
    EXPECT_FALSE(edits_of(1).empty());
    editor.undo();
    EXPECT_FALSE(editor.modified());
    editor.redo();
    editor.redo();
    EXPECT_FALSE(edits_of(0).empty() || edits_of(1).empty() || edits_of(2).empty());
}

TEST_F(PaintSpreadTest, EditsThatFollowLeavesAreCarried) {
    operation.frames = {2, 2, edit::Follow::kAll};
    paint();
    settle();
    const auto seen = segment(1);
    editor::PaintOperation there = operation;
    there.frames = {0, 0, edit::Follow::kNot};
    const Layer selected = editor::apply_operation(seen->canvas, *empty(*seen),
                                                   editor::leaves_for(seen->canvas, *empty(*seen), box, there), there);
    editor::PaintCarrier carrier(*place.index, operation.frames, 1, seen, selected->edits);
    voctree::EditLayer want_seen = *empty(*seen);
    voctree::add_edits(want_seen, carrier.seen_edits());
    EXPECT_EQ(edits_of(1), want_seen.edits);
    size_t carried = 0;
    while (const auto segment_index = carrier.next()) {
        const editor::PaintCarrier::Edits edits = carrier.edits_in(segment(*segment_index));
        voctree::EditLayer want = *empty(*segment(*segment_index));
        voctree::add_edits(want, edits);
        EXPECT_EQ(edits_of(*segment_index), want.edits) << *segment_index;
        carried += want.edits.size();
    }
    EXPECT_GT(carried, 10u);
}

TEST_F(PaintSpreadTest, WhatWasPaintedMeanwhileStays) {
    paint();
    hold();
    const Layer other = green_dot();
    ASSERT_TRUE(set(2, other));
    settle();
    EXPECT_EQ(edits_of(2), other->edits) << "a region is no list of edits";
    EXPECT_TRUE(was_notified("painted meanwhile"));
    EXPECT_FALSE(edits_of(0).empty());
}

TEST_F(PaintSpreadTest, EditsThatAreCarriedAreAddedToWhatWasPaintedMeanwhile) {
    operation.frames = {2, 2, edit::Follow::kAll};
    paint();
    hold();
    const Layer other = green_dot();
    ASSERT_TRUE(set(2, other));
    settle();
    size_t green = 0, red = 0;
    for (const voctree::LeafEdit& edit : edits_of(2)) {
        green += edit == other->edits[0];
        red += edit.colour == operation.colour;
    }
    EXPECT_EQ(green, 1u);
    EXPECT_GT(red, 5u);
    EXPECT_FALSE(was_notified("painted meanwhile"));
}

TEST_F(PaintSpreadTest, EachStrokeFindsWhatTheOneBeforeItPainted) {
    paint();
    operation.colour = {0, 0, 1};
    operation.opacity = 0.5f;
    const auto seen = segment(1);
    const Layer once = editor.document().paint.at(file(1));
    const editor::PaintedRegion twice = editor::paint_region(place, seen, once, operation, box);
    ASSERT_TRUE(set(1, twice.layer));
    spreads.start(place, anna, look, once, twice.layer, *twice.spread);
    settle();
    for (uint32_t segment_index = 0; segment_index < 3; ++segment_index)
        for (const voctree::LeafEdit& edit : edits_of(segment_index))
            EXPECT_EQ(edit.colour, glm::vec3(0.5f, 0, 0.5f)) << "blue over red in segment " << segment_index;
    EXPECT_FALSE(was_notified("painted meanwhile"));
}

TEST_F(PaintSpreadTest, NothingIsPaintedOnALayerThatIsGoneNorAfterUndo) {
    paint();
    editor.undo();
    settle();
    EXPECT_TRUE(edits_of(0).empty());
    EXPECT_FALSE(editor.modified());
    EXPECT_TRUE(was_notified("the layer has gone"));
    // On a layer that stays.
    const auto seen = segment(1);
    const Layer none = empty(*seen);
    ASSERT_TRUE(set(1, none));
    const editor::PaintedRegion painted = editor::paint_region(place, seen, none, operation, box);
    ASSERT_TRUE(set(1, painted.layer));
    spreads.start(place, anna, look, none, painted.layer, *painted.spread);
    editor.undo();
    settle();
    EXPECT_TRUE(edits_of(0).empty() && edits_of(1).empty());
    EXPECT_TRUE(was_notified("was undone"));
}

TEST_F(PaintSpreadTest, NothingIsPaintedWhereAnotherClipPlays) {
    paint();
    hold();
    edit::PerformerEdit other;
    other.clip = folder.path / "other.nvv";
    ASSERT_TRUE(editor.edit([&](edit::Document& document) { return edit::set_performer(document.file, anna, other); }));
    settle();
    EXPECT_TRUE(edits_of(0).empty());
    EXPECT_TRUE(was_notified("another clip plays now"));
}

TEST_F(PaintSpreadTest, WhereNothingIsSeenTheOthersArePaintedAllTheSame) {
    operation.frames = {4, 5, edit::Follow::kNot};
    const auto seen = segment(1);
    const editor::PaintedRegion painted = editor::paint_region(place, seen, empty(*seen), operation, box);
    EXPECT_FALSE(painted.layer);
    spreads.start(place, anna, look, empty(*seen), nullptr, *painted.spread);
    settle();
    EXPECT_TRUE(edits_of(0).empty() && edits_of(1).empty());
    EXPECT_FALSE(edits_of(2).empty());
    EXPECT_EQ(edit::paint_layers_of(editor.file(), anna)->size(), 1u);
    editor.undo();
    EXPECT_FALSE(editor.modified());
    const edit::Region nowhere = edit::box_region(glm::vec3(50), glm::vec3(51));
    operation.frames = {0, 5, edit::Follow::kNot};
    const editor::PaintedRegion nothing = editor::paint_region(place, seen, empty(*seen), operation, nowhere);
    spreads.start(place, anna, look, empty(*seen), nothing.layer, *nothing.spread);
    settle();
    EXPECT_TRUE(was_notified("nothing is there"));
    EXPECT_FALSE(editor.modified());
}

// Without an overlap, the nearer of two frames is seen, and painted.
TEST_F(PaintSpreadTest, BetweenTwoSegmentsTheNearerFrameIsMeant) {
    place = editor::PaintPlace(place.index, 1.4f);
    EXPECT_EQ(place.segment_index, 0u);
    EXPECT_EQ(place.clip_frame(), 1);
    EXPECT_EQ(editor::PaintPlace(place.index, 1.6f).clip_frame(), 2);
    EXPECT_EQ(editor::PaintPlace(place.index, 0.5f).clip_frame(), 0.5f);
    const float frame = place.clip_frame();
    const auto seen = segment(0);
    const editor::SeenPaint paint =
        editor::seen_paint(place, *seen, empty(*seen), {frame, frame, edit::Follow::kRun}, false);
    EXPECT_TRUE(paint.has_frames());
}

TEST_F(PaintSpreadTest, WhoPaintsIsNotCutOff) {
    paint();
    hold();
    EXPECT_TRUE(edits_of(0).empty());
    ASSERT_TRUE(editor.drag([&](edit::Document& document) { return edit::rename_node(document.file, anna, "berta"); }));
    spreads.update(true);
    EXPECT_TRUE(editor.dragging());
    EXPECT_TRUE(edits_of(0).empty());
    editor.end_drag();
    settle();
    EXPECT_FALSE(edits_of(0).empty());
}

TEST_F(PaintSpreadTest, ASegmentThatCannotBeReadIsReportedAndTheRestIsKept) {
    std::filesystem::remove(place.index->segments[2].file);
    paint();
    settle();
    EXPECT_TRUE(was_notified("000004.nvv"));
    EXPECT_FALSE(edits_of(0).empty()) << "it comes before";
    EXPECT_TRUE(edits_of(2).empty());
}

}  // namespace
}  // namespace neuvv::test

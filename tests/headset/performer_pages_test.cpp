// The panel's pages about the selected performer: its copies, its time, and what paints it.
#include "edit/tracks.h"
#include "headset/panel_at_a_stage.h"
#include "tools/headset/hands/hand_shapes.h"
#include "tools/headset/state/arrange.h"

namespace neuvv::test {
namespace {

struct PerformerPages : PanelAtAStage {
    PerformerPages() {
        state.editor.select(node("ben"));
        state.panel_visible = true;
    }
    stage::PerformerSettings settings(const std::string& name = "ben") const {
        return *edit::performer_on(state.editor.file(), node(name));
    }
    std::string time() const { return stage::text_of(settings().time); }
    float frame_of_ben() const { return state.evaluated.performers[*state.selected_performer()].frame; }
    void move_clock(double to_s) {
        state.clock.playing = false;
        state.clock.scrub(to_s);
        draw();
    }
};

TEST_F(PerformerPages, CopiesAreMadeAsThePageSaysInOneStep) {
    using enum edit::CopyPattern;
    for (const auto& [item, pattern] : {std::pair{"row", kRow}, {"ring", kRing}, {"fan", kFan}}) {
        state.editor.select(node("anna"));  // who would be in the way
        headset::delete_selected(state);
        draw();
        state.editor.select(node("ben"));
        draw();
        const size_t before = state.editor.node_count();
        press("copies page");
        press(item);
        EXPECT_EQ(state.copies.pattern, pattern);
        drag("count", {0.02, 0.05});
        drag("distance", {0.05});
        drag("arc", {0.1});
        drag("stagger", {0.1});
        EXPECT_GT(state.copies.stagger.value, 0.1);
        const uint32_t count = state.copies.count;
        EXPECT_GT(count, 3u);
        const std::vector<headset::PlannedCopy> planned = headset::planned_copies(state);
        ASSERT_EQ(planned.size(), count);
        press("make copies");
        ASSERT_EQ(state.editor.node_count(), before + count);
        EXPECT_EQ(state.editor.selected(), node("ben"));
        for (uint32_t copy = 0; copy < count; ++copy) {
            const std::string name = "ben " + std::to_string(copy + 2);
            EXPECT_LT(glm::distance(position(name), glm::dvec3(planned[copy].world_from_node[3])), 1e-6) << name;
            const stage::TimeMap map = settings(name).time;
            ASSERT_EQ(map.size(), 1u) << name;
            EXPECT_EQ(map[0].verb, stage::TimeVerb::kOffset);
            EXPECT_NEAR(map[0].a.value, (copy + 1) * state.copies.stagger.value, 1e-9) << name;
        }
        EXPECT_EQ(steps(), 2u);
        EXPECT_EQ(state.editor.node_count(), before + 1);
    }
}

TEST_F(PerformerPages, PlannedCopiesAreShownWhereTheyWillStand) {
    const auto corners_near = [&](glm::dvec3 at) {
        xr::EyeShapes shapes;
        shapes.begin(head.position, 0);
        headset::draw_interaction(shapes, state, interaction);
        size_t count = 0;
        for (const xr::ShapeVertex& corner : shapes.solid())
            count += glm::distance(glm::dvec3(corner.position), at) < 0.05;
        return count;
    };
    state.copies.distance_m = 3;
    draw();
    const auto [low, high] = editor::box_of(state, *state.selected_performer());
    const glm::dvec3 corner(headset::planned_copies(state).at(1).world_from_node * glm::dvec4(low, 1));
    EXPECT_NEAR(corner.x, (state.evaluated.performers[1].world_from_performer * glm::dvec4(low, 1)).x + 6, 1e-9);
    EXPECT_EQ(corners_near(corner), 0u);
    press("copies page");
    EXPECT_GT(corners_near(corner), 0u);
    state.editor.select({});
    draw();
    EXPECT_EQ(corners_near(corner), 0u) << "of nobody";
}

TEST_F(PerformerPages, APerformerIsRepeated) {
    press("time page");
    press("performer loop");
    EXPECT_EQ(time(), "loop");
    press("to and fro");
    EXPECT_EQ(time(), "ping-pong");
    press("once");
    EXPECT_EQ(time(), "");
    EXPECT_EQ(steps(), 3u);
}

TEST_F(PerformerPages, AFrozenPerformerKeepsThePresentFrameUntilItIsLetGo) {
    press("time page");
    move_clock(0.04);
    const float frozen_at = frame_of_ben();
    ASSERT_GT(frozen_at, 0);
    press("freeze");
    for (const double at_s : {0.0, 0.08}) {
        move_clock(at_s);
        EXPECT_EQ(frame_of_ben(), frozen_at);
    }
    press("freeze");
    move_clock(0);
    EXPECT_EQ(frame_of_ben(), 0);
}

TEST_F(PerformerPages, AnOffsetIsDraggedInOneStep) {
    press("time page");
    press("performer loop");
    drag("offset", {0.05, 0.1, 0.2});
    const double later = settings().time.back().a.value;
    EXPECT_EQ(settings().time.size(), 2u) << time();
    EXPECT_GT(later, 1);
    drag("offset", {-0.1, -0.25});
    EXPECT_EQ(settings().time.size(), 2u) << time() << ": dragging adds no operators";
    EXPECT_LT(settings().time.back().a.value, -1);
    press("later");
    EXPECT_EQ(steps(), 4u);
}

TEST_F(PerformerPages, ASpinIsDraggedBothWaysAndStopsInTheCentre) {
    press("time page");
    drag("spin", {0.05, 0.2});
    const double spin = settings().spin_deg_per_s;
    EXPECT_GT(spin, 30);
    EXPECT_LT(spin, 180);
    drag("spin", {-0.05, -0.2});
    EXPECT_NEAR(settings().spin_deg_per_s, -spin, 0.6 + 1e-6) << "pixels are 0.1 turns a minute apart";
    drag("spin", {0.1, 0.004});
    EXPECT_EQ(settings().spin_deg_per_s, 0);
    EXPECT_EQ(steps(), 3u);
}

TEST_F(PerformerPages, TheImageButtonGoesThroughTheFolderAndATipPaintsAgain) {
    using Mode = headset::HandBrush::Mode;
    press("paint");
    press("image");
    EXPECT_TRUE(was_notified("no PNG file"));
    EXPECT_EQ(state.brush.mode, Mode::kPaint);
    for (const char* name : {"a.png", "b.png"}) media::write_png(folder.path / name, media::Image(2, 2));
    for (const char* name : {"a.png", "b.png", "a.png"}) {
        press("image");
        EXPECT_EQ(state.brush.mode, Mode::kImage);
        EXPECT_EQ(state.image.filename(), name);
    }
    press("box");
    EXPECT_EQ(state.brush.mode, Mode::kPaint);
    press("image");
    EXPECT_EQ(state.image.filename(), "a.png") << "the one that was chosen before";
    press("by ray");
    press("pick colour");
    EXPECT_TRUE(state.brush.by_ray && state.picks_colour);
}

}  // namespace
}  // namespace neuvv::test

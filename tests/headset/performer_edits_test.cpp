// What the panel does with performers: life size, hiding, adding; and the numbers of files.
#include "tools/headset/state/performer_edits.h"

#include <fstream>

#include "headset/hands_at_a_stage.h"

namespace neuvv::test {
namespace {

using PerformerEdits = HandsAtAStage;

TEST_F(PerformerEdits, LifeSizeKeepsTheFeet) {
    const glm::dmat4 large =
        glm::rotate(glm::translate(glm::dmat4(1), glm::dvec3(0.3, 0.2, -3)), 0.7, glm::dvec3(0, 1, 0)) *
        glm::scale(glm::dmat4(1), glm::dvec3(2, 3, 2));
    state.editor.select(node("ben"));
    state.editor.edit([&](edit::Document& document) {
        edit::Placement placement;
        placement.matrix = large;
        return edit::place_node(document.file, node("ben"), placement);
    });
    frame();
    const glm::dvec4 feet(0.5, 0, 0.5, 1);  // of a clip whose box is the unit box
    headset::give_life_size(state);
    frame();
    const glm::dmat4 now = state.evaluated.pose.world_from_node[node("ben")];
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(glm::length(glm::dvec3(now[axis])), 1, 1e-9);
    EXPECT_LT(glm::distance(now * feet, large * feet), 1e-9);
    EXPECT_LT(glm::distance(glm::dvec3(now[2]), glm::dvec3(large[2]) / 2.0), 1e-9) << "it does not turn";
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(PerformerEdits, WhoIsBroughtHereFacesTheUser) {
    state.rig = {{1, 0, 3}, 0.6};
    state.editor.select(node("ben"));
    headset::bring_here(state, head);
    frame();
    const xr::Pose user = xr::world_from_tracking(state.rig) * head;
    const glm::dmat4 now = state.evaluated.pose.world_from_node[node("ben")];
    const glm::dvec3 feet = now * glm::dvec4(0.5, 0, 0.5, 1),
                     wanted = user * glm::dvec3(0, 0, -headset::kNewPerformer_m);
    EXPECT_LT(glm::distance(feet, glm::dvec3(wanted.x, state.floor_m, wanted.z)), 1e-6);
    EXPECT_GT(glm::dot(glm::normalize(glm::dvec3(now[2])), -xr::forward_of(user)), 0.9999) << "its front";
    EXPECT_NEAR(glm::length(glm::dvec3(now[0])), 1.6, 1e-9) << "as large as before";
    state.editor.select(node("anna"));
    headset::bring_here(state, head);
    frame();
    EXPECT_GT(glm::distance(position("anna"), position("ben")), 1.6) << "beside ben, who stands there";
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(PerformerEdits, AStageThatIsTooLargeFitsToTheRoomInOneStep) {
    const auto extent = [&] {
        glm::dvec3 low(INFINITY), high(-INFINITY);
        for (const stage::EvaluatedPerformer& performer : state.evaluated.performers)
            for (const glm::dvec3& corner : {glm::dvec3(0), glm::dvec3(1)}) {
                const glm::dvec3 at = performer.world_from_performer * glm::dvec4(corner, 1);
                low = glm::min(low, at);
                high = glm::max(high, at);
            }
        return std::pair{low, high};
    };
    const auto [low_before, high_before] = extent();
    ASSERT_NEAR(high_before.x - low_before.x, 3.2, 1e-9);
    headset::fit_to_room(state, head, {2.4, 2});
    frame();
    const auto [low, high] = extent();
    EXPECT_NEAR(high.x - low.x, 2.4, 1e-6);
    EXPECT_NEAR(low.y, state.floor_m, 1e-6);
    EXPECT_NEAR(high.z, head.position.z - headset::kNewPerformer_m, 1e-6) << "before the user";
    EXPECT_NEAR(position("ben").x - position("anna").x, 1.6 * 2.4 / 3.2, 1e-6) << "in the same order";
    EXPECT_EQ(undo_all(), 1u);
    frame();
    headset::fit_to_room(state, head, {8, 8});
    frame();
    EXPECT_NEAR(extent().second.x - extent().first.x, 3.2, 1e-6) << "nobody grows";
}

TEST_F(PerformerEdits, WhoIsHiddenIsNotPointedAtAndComesBack) {
    select(kBen);
    headset::hide_selected(state);
    frame();
    EXPECT_FALSE(state.editor.selected());
    ASSERT_EQ(headset::hidden_performers(state).size(), 1u);
    select(kBen);
    EXPECT_FALSE(state.editor.selected()) << "nobody is seen there";
    headset::show_performer(state, headset::hidden_performers(state)[0]);
    frame();
    EXPECT_TRUE(headset::hidden_performers(state).empty());
    EXPECT_EQ(state.editor.selected(), node("ben"));
    EXPECT_EQ(undo_all(), 2u);
}

TEST_F(PerformerEdits, ANewPerformerStandsBeforeTheUserAndIsOneStep) {
    state.rig.yaw_rad = glm::radians(90.0);
    state.rig.position = {1, 0, 2};
    const std::vector<std::filesystem::path> clips = headset::clips_at_hand(state.editor);
    ASSERT_EQ(clips.size(), 1u) << "the clip of both, which lies beside the stage, too";
    clips_are_read = false;
    headset::add_performer(state, clips[0], head);
    const uint64_t id = state.editor.id();
    frames(3);
    EXPECT_EQ(state.editor.id(), id) << "nothing is edited while its clip is read";
    ASSERT_TRUE(state.new_performer);
    state.new_performer->is_read = true;
    state.slider_edits = true;
    frames(3);
    EXPECT_EQ(state.editor.id(), id) << "nor while a hand holds a slider that edits";
    state.slider_edits = false;
    frames(3);
    ASSERT_EQ(state.stage->performers.size(), 3u);
    EXPECT_EQ(state.selected_performer(), 2u);
    const glm::dmat4& now = state.evaluated.pose.world_from_node[state.stage->performers[2].node];
    EXPECT_LT(glm::distance(glm::dvec3(now * glm::dvec4(0.5, 0, 0.5, 1)), glm::dvec3(1 - 2, 0, 2)), 1e-9)
        << "the feet are 2 m before the user, on the floor";
    EXPECT_LT(glm::distance(glm::dvec3(now[2]), glm::dvec3(1, 0, 0)), 1e-9) << "it faces the user";
    EXPECT_FALSE(state.editor.dragging());
    EXPECT_EQ(undo_all(), 1u);
    frame();
    EXPECT_EQ(state.stage->performers.size(), 2u);
}

TEST_F(PerformerEdits, ClipsBesideTheStageAreOffered) {
    std::filesystem::copy_file(clip, folder.path / "cleo.nvv");
    std::ofstream(folder.path / "notes.txt") << "no clip";
    const std::vector<std::filesystem::path> clips = headset::clips_at_hand(state.editor);
    ASSERT_EQ(clips.size(), 2u);
    EXPECT_EQ(clips[0].filename(), "figure.nvv") << "those that are on the stage come first";
    EXPECT_EQ(clips[1].filename(), "cleo.nvv");
}

TEST_F(PerformerEdits, ACopyOfAFileHasTheNextNumber) {
    const auto touch = [&](const char* name) { std::ofstream(folder.path / name) << "{}"; };
    const auto after = [&](const char* name) { return headset::next_numbered(folder.path / name).filename(); };
    EXPECT_EQ(after("show.gltf"), "show-2.gltf");
    touch("show-2.gltf");
    EXPECT_EQ(after("show.gltf"), "show-3.gltf");
    EXPECT_EQ(after("show-2.gltf"), "show-3.gltf");
    EXPECT_EQ(after("show-9.gltf"), "show-10.gltf");
    EXPECT_EQ(after("late-show.gltf"), "late-show-2.gltf");
    EXPECT_EQ(after("show-.gltf"), "show--2.gltf");
    EXPECT_EQ(after("show-12345678901.gltf"), "show-12345678901-2.gltf");
}

}  // namespace
}  // namespace neuvv::test

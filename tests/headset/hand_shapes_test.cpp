#include "tools/headset/hands/hand_shapes.h"

#include "headset/hands_at_a_stage.h"

namespace neuvv::test {
namespace {

struct HandShapesTest : HandsAtAStage {
    xr::EyeShapes shapes;
    HandShapesTest() { shapes.begin(head.position, 0); }
    // The number of triangle corners near a position.
    static size_t corners_at(std::span<const xr::ShapeVertex> list, glm::dvec3 position, double within_m) {
        return static_cast<size_t>(std::count_if(list.begin(), list.end(), [&](const xr::ShapeVertex& corner) {
            return glm::distance(glm::dvec3(corner.position), position) < within_m;
        }));
    }
};

TEST_F(HandShapesTest, AHandThatIsSeenItselfHoldsNoController) {
    headset::draw_interaction(shapes, state, interaction);
    const size_t both = corners_at(shapes.solid(), kRightHand, 0.11);
    EXPECT_GT(both, 0u);
    inputs[xr::kRight].bare_hand = true;
    frame();
    shapes.begin(head.position, 0);
    headset::draw_interaction(shapes, state, interaction);
    EXPECT_EQ(corners_at(shapes.solid(), kRightHand, 0.11), 0u);
    EXPECT_GT(corners_at(shapes.solid(), kLeftHand, 0.11), 0u);
}

TEST_F(HandShapesTest, ThereIsAFloorWhereThereIsNoSet) {
    headset::draw_floor(shapes, state);
    EXPECT_TRUE(shapes.translucent().empty()) << "a new stage has one";
    for (int nodes = 10; nodes > 0 && editor::has_set(*state.stage); --nodes) {
        for (uint32_t i = 0; i < state.stage->scene.nodes.size(); ++i)
            if (state.stage->scene.nodes[i].draws_mesh()) {
                ASSERT_TRUE(
                    state.editor.edit([&](edit::Document& document) { return edit::remove_node(document.file, i); }));
                break;
            }
        frame();
    }
    ASSERT_FALSE(editor::has_set(*state.stage));
    headset::draw_floor(shapes, state);
    EXPECT_FALSE(shapes.translucent().empty());
    for (const xr::ShapeVertex& corner : shapes.translucent()) EXPECT_NEAR(corner.position.y, state.floor_m, 0.01);
    const auto is_dark_at = [&](glm::dvec3 centre) {
        centre.y = state.floor_m;
        return std::ranges::any_of(shapes.translucent(), [&](const xr::ShapeVertex& corner) {
            return glm::distance(glm::dvec3(corner.position), centre) < 0.01 && corner.colour.r == 0 &&
                   corner.colour.a > 0.5f;
        });
    };
    EXPECT_TRUE(is_dark_at(kAnna) && is_dark_at(kBen)) << "each has a shadow below it";
    EXPECT_FALSE(is_dark_at({0, 0, -2}));
}

TEST_F(HandShapesTest, ABrushIsSeenWithinAPerformer) {
    state.tool = headset::HandTool::kPaint;
    frame();
    headset::draw_interaction(shapes, state, interaction);
    const glm::dvec3 tip = headset::HandPainter::tip_of(*interaction.hands[xr::kRight].aim);
    EXPECT_GT(corners_at(shapes.on_top(), tip, state.brush.radius_m + 1e-6), 100u);
    EXPECT_EQ(corners_at(shapes.translucent(), tip, state.brush.radius_m + 1e-6), shapes.on_top().size());
}

}  // namespace
}  // namespace neuvv::test

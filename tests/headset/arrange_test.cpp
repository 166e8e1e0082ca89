// Boxes, copies and the floor, for performers with floaters.
#include "tools/headset/state/arrange.h"

#include "headset/hands_at_a_stage.h"
#include "tools/headset/program.h"

namespace neuvv::test {
namespace {

// The figure, raised by kLifted cells, over two specks of density on either side, as training leaves them.
constexpr uint32_t kLifted = 12;
voctree::VOctree floating_tree() {
    const voctree::VOctree figure = figure_tree();
    voctree::VOctree tree = figure;
    std::vector<voctree::LeafPosition> positions;
    std::vector<const float*> from;
    const std::vector<voctree::LeafPosition> of_figure = voctree::leaf_positions(figure);
    for (uint32_t leaf = 0; leaf < figure.leaf_count; ++leaf) {
        voctree::LeafPosition position = of_figure[leaf];
        position.y += kLifted;
        if (position.y >= kFigureSide) continue;
        positions.push_back(position);
        from.push_back(figure.leaf(leaf));
    }
    std::vector<float> speck(figure.weights_per_leaf());
    speck[0] = speck[1] = 250;
    for (const uint32_t x : {0u, kFigureSide - 1}) {
        positions.push_back({x, 0, 0, kFigureDepth});
        from.push_back(speck.data());
    }
    voctree::replace_leaves(tree, positions, from);
    return tree;
}
constexpr double kFeet_m = 1.6 * kLifted / kFigureSide;  // above the performer's origin

struct ArrangeTest : HandsAtAStage {
    ArrangeTest() {
        jobs.run_posted();
        leaves = std::make_shared<const voctree::SolidLeaves>(floating_tree());
        show();
        state.editor.select(node("ben"));
    }
    // As the program does in each frame.
    void show() {
        state.follow_document();
        state.evaluate();
        state.solid.assign(state.stage->performers.size(), editor::SolidPart(leaves, 0));
    }
    double feet(const std::string& name) const { return position(name).y + kFeet_m; }
    void lift(double to_m) {
        headset::move_node_to(state, node("ben"),
                              glm::translate(glm::dmat4(1), glm::dvec3(0, to_m - feet("ben"), 0)) *
                                  state.evaluated.pose.world_from_node[node("ben")]);
        show();
    }
    std::shared_ptr<const voctree::SolidLeaves> leaves;
};

TEST_F(ArrangeTest, FeetAreThoseOfTheBodyAndNotOfAFloater) {
    for (const double at_m : {0.7, -0.7}) {
        lift(at_m);
        headset::put_selected_on_floor(state);
        show();
        EXPECT_NEAR(feet("ben"), 0, 1e-6) << "the floater is below the floor";
    }
    EXPECT_NEAR(position("anna").y, 0, 1e-9) << "who is not selected";
}

TEST_F(ArrangeTest, FeetThatAreFarFromTheFloorStayThere) {
    for (const double at_m : {1.4, -1.4}) {
        lift(at_m);
        headset::put_selected_on_floor(state);
        show();
        EXPECT_NEAR(feet("ben"), at_m, 1e-6);
        EXPECT_TRUE(was_notified("move it nearer first"));
    }
}

TEST_F(ArrangeTest, ACopyStandsBesideTheBodyAndNotBesideItsFloaters) {
    headset::duplicate_selected(state);
    show();
    ASSERT_EQ(state.stage->performers.size(), 3u);
    EXPECT_EQ(state.selected_performer(), 2u);
    const auto [low, high] = leaves->box_at(0);
    const glm::dvec3 copy(state.evaluated.pose.world_from_node[state.stage->performers[2].node][3]);
    EXPECT_NEAR(copy.x - position("ben").x, 1.1 * 1.6 * (high.x - low.x), 1e-6);
    EXPECT_LT(high.x - low.x, 0.8) << "the floaters are a whole metre apart";
}

TEST_F(ArrangeTest, NoCopyStandsInsideAnother) {
    const auto [low, high] = leaves->box_at(0);
    const double width_m = 1.6 * (high.x - low.x);
    for (int copy = 0; copy < 4; ++copy) {
        state.editor.select(node("ben"));
        headset::duplicate_selected(state);
        show();
    }
    std::vector<double> at;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers)
        at.push_back(performer.world_from_performer[3].x);
    ASSERT_EQ(at.size(), 6u);
    std::sort(at.begin(), at.end());
    for (size_t i = 1; i < at.size(); ++i) EXPECT_GT(at[i] - at[i - 1], 0.94 * width_m) << i;
}

TEST_F(ArrangeTest, UndoingACopySelectsWhatWasCopiedAndSaysNoNumbersOfNodes) {
    headset::duplicate_selected(state);
    show();
    EXPECT_NE(state.editor.selected(), node("ben"));
    state.editor.undo();
    show();
    EXPECT_EQ(state.editor.selected(), node("ben"));
    const std::vector<editor::Notice> notices = state.editor.take_notices();
    ASSERT_FALSE(notices.empty());
    EXPECT_EQ(headset::without_node_numbers(notices.back().text), "undone: \"ben\": a copy");
    EXPECT_EQ(headset::without_node_numbers("a (node b) of \"c\" (node 12)"), "a (node b) of \"c\"");
    state.editor.select(node("anna"));
    headset::delete_selected(state);
    show();
    state.editor.undo();
    show();
    EXPECT_EQ(state.editor.selected(), node("anna")) << "what comes back is selected, too";
}

TEST_F(ArrangeTest, CopiesThatWouldStandInOthersAreRefused) {
    state.copies = {.count = 2, .distance_m = 3};
    headset::make_copies(state);
    show();
    ASSERT_EQ(state.stage->performers.size(), 4u);
    const auto planned = headset::planned_copies(state);
    ASSERT_EQ(planned.size(), 2u);
    EXPECT_TRUE(planned[0].is_taken && planned[1].is_taken);
    headset::make_copies(state);
    show();
    EXPECT_EQ(state.stage->performers.size(), 4u) << "the same copies once more";
    EXPECT_TRUE(was_notified("red box"));
    state.copies.distance_m = 4.5;
    headset::make_copies(state);
    show();
    EXPECT_EQ(state.stage->performers.size(), 6u) << "between the others";
}

TEST_F(ArrangeTest, ARayThroughAFloatersPartOfTheBoxTakesNobody) {
    const glm::dvec3 beside = position("ben") + glm::dvec3(1.5, 1.4, 0.8);
    point(xr::kRight, beside + glm::dvec3(0, 0, 3), beside);
    interaction.update(state, inputs, head, 1.0 / 90);
    EXPECT_NE(interaction.hands[xr::kRight].hit.target, headset::PointerHit::Target::kPerformer);
    state.solid.clear();
    interaction.update(state, inputs, head, 1.0 / 90);
    EXPECT_EQ(interaction.hands[xr::kRight].hit.target, headset::PointerHit::Target::kPerformer)
        << "as the clip's own box would";
}

}  // namespace
}  // namespace neuvv::test

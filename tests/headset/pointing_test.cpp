// What pointer rays take: surfaces, and boxes only where a ray meets no surface.
#include "tools/headset/hands/pointing.h"

#include "headset/hands_at_a_stage.h"

namespace neuvv::test {
namespace {

struct PointingTest : HandsAtAStage {
    // A frame in which the right hand's ray meets this surface, and the left hand's none.
    void frame_with(std::optional<headset::SurfaceHit> hit) {
        jobs.run_posted();
        state.follow_document();
        state.evaluate();
        interaction.update(state, inputs, head, 1.0 / 90, [&](std::span<const Ray> rays) {
            asked = rays.size();
            std::vector<std::optional<headset::SurfaceHit>> hits(rays.size());
            hits[0] = hit;  // the left hand sees nothing in these tests
            return hits;
        });
    }
    PointingTest() {
        inputs[xr::kLeft].aim.reset();
        inputs[xr::kLeft].grip.reset();
    }
    uint32_t performer(const std::string& name) const {
        for (uint32_t i = 0; i < state.stage->performers.size(); ++i)
            if (state.stage->performers[i].name == name) return i;
        throw std::runtime_error("there is no " + name);
    }
    const headset::Hand& hand() const { return interaction.hands[xr::kRight]; }
    size_t asked = 0;
};

TEST_F(PointingTest, ASurfaceGoesBeforeANearerBox) {
    inputs[xr::kRight].select = 1;
    frame_with(headset::SurfaceHit{performer("anna"), 2.5});  // the ray goes through ben's box
    EXPECT_EQ(asked, 1u) << "a hand that is not seen has no ray";
    EXPECT_EQ(state.editor.selected(), node("anna"));
    EXPECT_EQ(hand().hit.distance_m, 2.5) << "where the dot is drawn";
    EXPECT_EQ(headset::pointed_performer(interaction.hands), performer("anna"));
}

TEST_F(PointingTest, ABoxCountsWhereNoSurfaceIsMet) {
    inputs[xr::kRight].select = 1;
    frame_with(std::nullopt);
    EXPECT_EQ(state.editor.selected(), node("ben"));
}

TEST_F(PointingTest, AnotherPerformerUnderTheRayIsFelt) {
    const headset::SurfaceHit anna{performer("anna"), 2.5}, ben{performer("ben"), 2};
    frame_with(anna);
    EXPECT_GT(hand().vibration, 0);
    frame_with(headset::SurfaceHit{performer("anna"), 2.4});
    EXPECT_EQ(hand().vibration, 0) << "the same performer is not felt again";
    frame_with(ben);
    EXPECT_GT(hand().vibration, 0);
    point(xr::kRight, kRightHand, {0, 5, -2});
    frame_with(std::nullopt);
    EXPECT_EQ(hand().vibration, 0) << "nobody is under the ray";
    EXPECT_FALSE(headset::pointed_performer(interaction.hands));
    frame_with(ben);
    EXPECT_GT(hand().vibration, 0);
}

TEST_F(PointingTest, ARayThatHitsThePanelAsksForNoSurface) {
    state.panel_visible = true;
    frame_with(std::nullopt);
    point(xr::kRight, kRightHand, interaction.panel->point_at({0.5, 0.5}));
    asked = 77;
    frame_with(std::nullopt);
    EXPECT_EQ(asked, 77u);
    EXPECT_EQ(hand().hit.target, headset::PointerHit::Target::kPanel);
}

}  // namespace
}  // namespace neuvv::test

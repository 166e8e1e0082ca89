// Pointing at performers: what the ray meets is what it takes.
#include "edit/operations.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

struct Pointing : XrSession {
    // The ray from kRightHand to anna's head goes through the upper right part of ben's box, where ben has no leaf.
    void add_ben() const {
        stage::StageFile file = stage::read_stage_file(stage);
        add_figure(file, "ben", {-1.31, 0, -2});
        stage::save_stage_file(file, stage);
    }
    static constexpr glm::dvec3 kAnnaHead = glm::dvec3(-0.08, 0.992, -2), kBenHead = glm::dvec3(-0.59, 0.992, -1.2);
    static XrScript clicking_at(glm::dvec3 target) {
        XrScript script;
        script.hand(0, "right", kRightHand, target);
        script.hand(0, "left", kLeftHand, {-3, 1, -4});
        script.click(kReady + 2, "right", "trigger/value");
        script.end(kReady + 8);
        return script;
    }
};

TEST_F(Pointing, ARayTakesThePerformerWhoseSurfaceItMeets) {
    add_ben();
    const XrRun anna = run(clicking_at(kAnnaHead)), ben = run(clicking_at(kBenHead));
    expect_clean(anna);
    expect_clean(ben);
    EXPECT_EQ(anna.seen["selected"], "anna") << "ben's box is nearer, but he is beside the ray";
    EXPECT_EQ(ben.seen["selected"], "ben");
}

TEST_F(Pointing, AHandFeelsThatAnotherPerformerComesUnderItsRay) {
    add_ben();
    XrScript script;
    script.hand(0, "right", kRightHand, {3, 4, -4});
    script.hand(0, "left", kLeftHand, {-3, 4, 0});
    script.end(kReady + 10);
    const XrRun nobody = run(script);
    script.hand(kReady + 2, "right", kRightHand, kAnnaHead);
    script.hand(kReady + 5, "right", kRightHand, kBenHead);
    const XrRun both = run(script);
    expect_clean(both);
    EXPECT_EQ(nobody.report["haptics"].size(), 0u);
    EXPECT_EQ(both.report["haptics"].size(), 2u) << both.report["haptics"];
}

}  // namespace
}  // namespace neuvv::test

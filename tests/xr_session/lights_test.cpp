// Lights in the headset: held, opened by the stick, aimed at scenery, and saved.
#include "edit/light_values.h"
#include "edit/operations.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Lights : XrSession {
    const glm::dvec3 lamp{1.0, 1.7, -0.9}, on_wall{1.5, 1.0, -0.4};
    Lights() {
        stage::StageFile file = stage::read_stage_file(stage);
        edit::Placement light, wall;
        light.at = lamp;
        light.aim = kAnna;
        edit::place_node(file, edit::find_node(file, "key"), light);
        wall.at = glm::dvec3(1.5, 1, 0);
        wall.turn_deg = glm::dvec3(0, 0, 90);
        edit::place_node(file, edit::find_node(file, "floor"), wall);
        stage::save_stage_file(file, stage);
    }
    // The panel is visible and shows the lights by frame 18.
    XrScript with_lights() {
        XrScript script;
        script.hand(0, "right", kRightHand, {3, 4, 0});
        script.hand(0, "left", kLeftHand, {-3, 4, 0});
        script.click(kReady, "left", "y/click");
        press(script, 10, panel_after(script, kReady + 6), "lights");
        return script;
    }
};

TEST_F(Lights, AGripAndItsStickOpenALampThatThenLooksAtTheSet) {
    XrScript script = with_lights();
    const json items = panel_after(script, 22);
    EXPECT_TRUE(items.contains("brightness")) << "the rows are there before a light is selected";
    script.hand(20, "right", kRightHand, lamp);
    script.input(22, "right", "squeeze/value", 1);
    script.stick(24, "right", {-1, 0});
    script.save(44);
    script.stick(46, "right", {0, 0});
    script.input(48, "right", "squeeze/value", 0);
    script.hand(52, "right", kRightHand, on_wall);
    script.input(54, "right", "trigger/value", 1);
    script.save(56);
    script.input(58, "right", "trigger/value", 0);
    press(script, 62, items, "save");
    script.end(62 + kPress + 6);
    const XrRun run = this->run(script, {"--no-mask"});
    expect_clean(run);
    const stage::StageFile file = stage::read_stage_file(stage);
    const uint32_t key = edit::find_node(file, "key");
    const double before_deg = 36;  // of a new stage
    EXPECT_LT(edit::light_on(file, key)->outer_cone_deg, before_deg * 0.95) << run.log;
    const edit::NodeTransform placed = edit::transform_of(file, key);
    EXPECT_LT(glm::distance(placed.translation, lamp), 0.01);
    EXPECT_LT(glm::distance(placed.rotation * glm::dvec3(0, 0, -1), glm::normalize(on_wall - placed.translation)),
              0.01);
    EXPECT_EQ(run.seen["turned_deg"], 0.0);
}

}  // namespace
}  // namespace neuvv::test

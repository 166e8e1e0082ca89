// The panel as both eyes see it, and what it saves.
#include "golden/golden.h"
#include "xr_session/xr_session.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Panel : XrSession {
    static XrScript with_hands() {
        XrScript script;
        script.hand(0, "right", kRightHand, {3, 4, -4});
        script.hand(0, "left", kLeftHand, {-3, 4, -4});
        return script;
    }
};

TEST_F(Panel, BothEyesSeeAllOfIt) {
    XrScript script = with_hands();
    script.click(kReady, "left", "y/click");
    script.end(kReady + 6);
    const XrRun run = this->run(script);
    expect_clean(run);
    const glm::dvec3 head(0, 1.5, 0), ahead = glm::normalize(glm::dvec3(0, 1.2, -2) - head);
    ASSERT_GT(run.seen["panel"].size(), 10u);
    for (const auto& [name, at] : run.seen["panel"].items()) {
        const glm::dvec3 to_item = glm::normalize(item_position(at) - head);
        EXPECT_GT(glm::dot(to_item, ahead), std::cos(glm::radians(34.0))) << name << " is far from the view's middle";
    }
}

TEST_F(Panel, ItSavesUnderTheNextNumber) {
    XrScript script = with_hands();
    script.click(kReady, "left", "y/click");
    const json performer_page = panel_after(script, kReady + 6);
    press(script, 10, performer_page, "stage page");
    const json stage_page = panel_after(script, 10 + kPress + 2);
    press(script, 10 + kPress, stage_page, "save as");
    script.end(10 + 2 * kPress + 6);
    const XrRun run = this->run(script);
    expect_clean(run);
    const std::filesystem::path copy = folder.path / "stage-2.gltf";
    EXPECT_TRUE(std::filesystem::exists(copy)) << run.log;
    EXPECT_NE(run.log.find("saved " + copy.string()), std::string::npos) << run.log;
}

}  // namespace
}  // namespace neuvv::test

// Hints at the controllers: what they say, and where they are.
#include "tools/headset/labels.h"

#include "headset/hands_at_a_stage.h"

namespace neuvv::test {
namespace {

std::vector<std::string> lines_of(int role, const std::map<xr::HandAction, std::string>& left,
                                  const std::map<xr::HandAction, std::string>& right) {
    const auto hints = headset::hints_of(role, [&](xr::HandAction action, int hand) {
        const auto& buttons = hand == xr::kLeft ? left : right;
        const auto found = buttons.find(action);
        return found == buttons.end() ? std::string() : found->second;
    });
    std::vector<std::string> lines;
    for (const headset::ButtonHint& hint : hints) lines.push_back(hint.text);
    return lines;
}

TEST(HintLines, WithoutAButtonForGrabbingTheLongPressIsSaid) {
    const std::map<xr::HandAction, std::string> simple{{xr::HandAction::kSelect, "Select"},
                                                       {xr::HandAction::kMenu, "Menu"}};
    EXPECT_EQ(lines_of(xr::kRight, simple, simple),
              (std::vector<std::string>{"Select: select, press, paint", "Menu: panel", "Select, held: hold and move"}));
}

TEST(HintLines, WithoutAMenuTheLongPressOfTheLeftHandIsSaid) {
    const std::map<xr::HandAction, std::string> pinch{{xr::HandAction::kSelect, "Pinch"}};
    EXPECT_EQ(lines_of(xr::kLeft, pinch, pinch),
              (std::vector<std::string>{"Pinch: select, press", "Pinch, held: hold and move",
                                        "Pinch, held on nothing: panel"}));
    EXPECT_EQ(lines_of(xr::kRight, pinch, pinch).size(), 2u);
    const std::map<xr::HandAction, std::string> with_menu{
        {xr::HandAction::kSelect, "Trigger"}, {xr::HandAction::kGrab, "Squeeze"}, {xr::HandAction::kMenu, "Menu"}};
    const std::map<xr::HandAction, std::string> without{{xr::HandAction::kSelect, "Trigger"},
                                                        {xr::HandAction::kGrab, "Squeeze"}};
    EXPECT_EQ(lines_of(xr::kLeft, without, with_menu).size(), 2u) << "the other hand has a menu";
}

struct HintsShown : HandsAtAStage {
    size_t shown(int role) const { return headset::shown_hints(state, interaction, hints, role).count; }
    static std::string name_of(xr::HandAction, int) { return "Button"; }
    const headset::ButtonHints hints{headset::hints_of(xr::kLeft, name_of), headset::hints_of(xr::kRight, name_of)};
};

TEST_F(HintsShown, NameTheButtonsUntilTheyAreUsed) {
    const size_t all = hints[xr::kRight].size();
    EXPECT_EQ(shown(xr::kRight), all);
    inputs[xr::kRight].play = true;
    frame();
    EXPECT_EQ(shown(xr::kRight), all - 1);
    EXPECT_EQ(shown(xr::kLeft), hints[xr::kLeft].size());
    inputs[xr::kLeft].menu = true;
    frame();
    for (const int role : {xr::kLeft, xr::kRight})
        EXPECT_EQ(shown(role), hints[static_cast<size_t>(role)].size()) << "while the panel is open, all are shown";
    state.hints = false;
    EXPECT_EQ(shown(xr::kRight), 0u);
}

struct HintPlaces : HandsAtAStage {
    xr::Pose plate() const { return headset::hint_plate(interaction.hands[xr::kRight], world_head(), 1, is_new); }
    xr::Pose world_head() const { return xr::world_from_tracking(state.rig) * head; }
    double from_middle_deg() const {
        const glm::dvec3 towards = glm::normalize(plate().position - world_head().position);
        return glm::degrees(std::acos(glm::clamp(glm::dot(towards, xr::forward_of(world_head())), -1.0, 1.0)));
    }
    bool is_new = true;
};

TEST_F(HintPlaces, HandsThatHangDownHaveTheirHintsInView) {
    point(xr::kRight, {0.25, 0.75, -0.1}, {0.25, 0.75, -2});
    frame();
    EXPECT_LT(from_middle_deg(), 25) << "in view";
    EXPECT_GT((xr::inverse(world_head()) * plate().position).x, 0) << "on the hand's side";
    is_new = false;
    EXPECT_GT(from_middle_deg(), 60) << "once a button was used, at the hand";
    is_new = true;
    point(xr::kRight, {0.1, 1.4, -0.5}, {0.1, 1.4, -2});
    frame();
    EXPECT_LT(glm::distance(plate().position, glm::dvec3(0.1, 1.4, -0.5)), 0.2) << "a raised hand has them beside it";
}

}  // namespace
}  // namespace neuvv::test

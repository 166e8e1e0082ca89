#include "tools/headset/hands/labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace neuvv::headset {

namespace {

constexpr double kLine_rad = glm::radians(1.3);  // the height of a line, as it is seen
constexpr double kAbove = 0.7;                   // lines between the dot and the plate
constexpr double kNearer = 0.88;  // of the dot's distance, so that no body beside the dot covers the label

constexpr double kHintLine_rad = glm::radians(1.2), kHintAside_m = 0.11, kHintAbove_m = 0.02;
// Where the plate of a hand is that is out of view: so far below the centre of the view and beside it.
constexpr double kHintInView_rad = glm::radians(24.0), kHintDown_rad = glm::radians(16.0),
                 kHintSide_rad = glm::radians(17.0), kHintAway_m = 1;
constexpr double kStatusDown_rad = glm::radians(21.0);

struct ButtonUse {
    xr::HandAction action;
    bool UsedButtons::*button;
    std::array<const char*, xr::kHands> use;  // by role
};
constexpr ButtonUse kUses[] = {
    {xr::HandAction::kSelect, &UsedButtons::select, {"select, press", "select, press, paint"}},
    {xr::HandAction::kGrab, &UsedButtons::grab, {"hold and move", "hold and move"}},
    {xr::HandAction::kStick, &UsedButtons::stick, {"teleport, step", "turn, speed"}},
    {xr::HandAction::kMenu, &UsedButtons::menu, {"panel", "panel"}},
    {xr::HandAction::kPlay, &UsedButtons::play, {"play, pause", "play, pause"}},
    {xr::HandAction::kUndo, &UsedButtons::undo, {"undo", "undo"}},
    {xr::HandAction::kDuplicate, &UsedButtons::duplicate, {"copy", "copy"}}};

static_assert(std::size(kUses) + 2 <= std::tuple_size_v<decltype(ShownHints::lines)>);

}  // namespace

ButtonHints make_hints(const xr::Actions& actions, const HeadsetState& state) {
    ButtonHints hints;
    for (int role = 0; role < xr::kHands; ++role)
        hints[role] = hints_of(role, [&](xr::HandAction action, int of_role) {
            return actions.button_name(action, state.hand_of(of_role));
        });
    return hints;
}

std::vector<ButtonHint> hints_of(int role, const ButtonName& name_of) {
    std::vector<ButtonHint> hints;
    for (const ButtonUse& use : kUses)
        if (const std::string name = name_of(use.action, role); !name.empty())
            hints.push_back({use.button, fmt::format("{}: {}", name, use.use[role])});
    const std::string select = name_of(xr::HandAction::kSelect, role);
    if (select.empty()) return hints;
    if (name_of(xr::HandAction::kGrab, role).empty())
        hints.push_back({&UsedButtons::grab, fmt::format("{}, held: hold and move", select)});
    const bool has_menu =
        !name_of(xr::HandAction::kMenu, xr::kLeft).empty() || !name_of(xr::HandAction::kMenu, xr::kRight).empty();
    if (role == xr::kLeft && !has_menu)
        hints.push_back({&UsedButtons::menu, fmt::format("{}, held on nothing: panel", select)});
    return hints;
}

namespace {

// Of bare hands, where the runtime tracks joints alone.
const std::vector<ButtonHint>& pinch_hints(int role) {
    const auto make = [](int of_role) {
        return hints_of(of_role, [](xr::HandAction action, int) {
            return std::string(action == xr::HandAction::kSelect ? "Pinch" : "");
        });
    };
    static const ButtonHints hints{make(0), make(1)};
    return hints[static_cast<size_t>(role)];
}

}  // namespace

ShownHints shown_hints(const HeadsetState& state, const Interaction& interaction, const ButtonHints& hints, int role) {
    ShownHints shown;
    if (!state.hints) return shown;
    const bool pinches = hints[role].empty() && interaction.hands[role].input.bare_hand;
    for (const ButtonHint& hint : pinches ? pinch_hints(role) : hints[role])
        if (interaction.panel || !(interaction.used_buttons[role].*hint.button)) shown.lines[shown.count++] = hint.text;
    return shown;
}

xr::Pose hint_plate(const Hand& hand, const xr::Pose& world_head, double outwards, bool is_new) {
    const xr::Pose& grip = hand.grip ? *hand.grip : *hand.aim;
    const double distance_m = glm::distance(grip.position, world_head.position);
    const glm::dvec3 towards = (grip.position - world_head.position) / distance_m;
    const double away_rad = std::acos(glm::clamp(glm::dot(towards, xr::forward_of(world_head)), -1.0, 1.0));
    if (!is_new || away_rad < kHintInView_rad) {
        const glm::dquat facing = upright_towards(towards);
        return {grip.position + facing * glm::dvec3(outwards * kHintAside_m, kHintAbove_m, 0), facing};
    }
    const glm::dquat level = upright_towards(xr::forward_of(world_head));
    const glm::dvec3 to_plate =
        level * glm::normalize(glm::dvec3(outwards * std::tan(kHintSide_rad), -std::tan(kHintDown_rad), -1));
    return {world_head.position + kHintAway_m * to_plate, upright_towards(to_plate)};
}

void draw_hints(xr::EyeShapes& shapes, const LabelFont& font, const HeadsetState& state, const Interaction& interaction,
                const ButtonHints& hints, const xr::Pose& world_head) {
    for (int role = 0; role < xr::kHands; ++role) {
        const Hand& hand = interaction.hands[role];
        const auto& grip = hand.grip ? hand.grip : hand.aim;
        const auto [lines, count] = shown_hints(state, interaction, hints, role);
        const double distance_m = grip ? glm::distance(grip->position, world_head.position) : 0;
        if (count == 0 || distance_m < 0.05) continue;
        const double outwards = state.hand_of(role) == xr::kLeft ? -1 : 1;
        const bool is_new = !interaction.used_buttons[role].any();
        const xr::Pose plate = hint_plate(hand, world_head, outwards, is_new);
        font.draw(shapes, plate, glm::distance(plate.position, world_head.position) * kHintLine_rad,
                  std::span(lines).first(count));
    }
}

void draw_status(xr::EyeShapes& shapes, const LabelFont& font, std::span<const std::string> lines,
                 const xr::Pose& world_head) {
    if (lines.empty()) return;
    const glm::dvec3 to_plate =
        upright_towards(xr::forward_of(world_head)) * glm::normalize(glm::dvec3(0, -std::tan(kStatusDown_rad), -1));
    const std::vector<std::string_view> views(lines.begin(), lines.end());
    font.draw(shapes, {world_head.position + kHintAway_m * to_plate, upright_towards(to_plate)},
              kHintAway_m * kHintLine_rad, views);
}

std::optional<RayLabel> label_of_ray(const HeadsetState& state, const Interaction& interaction, int role) {
    const Hand& hand = interaction.hands[role];
    if (const auto opening = interaction.lights.opening(); opening && interaction.lights.is_holding(role))
        return RayLabel{fmt::format("{} {:.0f}°", opening->verb, opening->degrees), interaction.lights.distance_m()};
    if (hand.hit.target != PointerHit::Target::kPerformer || interaction.grab.is_active()) return std::nullopt;
    return RayLabel{state.stage->performers[hand.hit.performer].name, hand.hit.distance_m};
}

void draw_names(xr::EyeShapes& shapes, const LabelFont& font, const HeadsetState& state, const Interaction& interaction,
                const xr::Pose& world_head) {
    for (int which = 0; which < xr::kHands; ++which) {
        const Hand& hand = interaction.hands[which];
        const auto label = hand.aim ? label_of_ray(state, interaction, which) : std::nullopt;
        if (!label) continue;
        const Ray ray = xr::ray_of(*hand.aim);
        const glm::dvec3 dot = ray.origin + label->distance_m * ray.direction;
        const glm::dvec3 at = glm::mix(world_head.position, dot, kNearer);
        const double distance_m = glm::distance(at, world_head.position);
        if (distance_m < 0.05) continue;
        const glm::dquat facing = upright_towards((at - world_head.position) / distance_m);
        const double line_m = distance_m * kLine_rad;
        const std::string_view name = label->text;
        font.draw(shapes, {at + facing * glm::dvec3(0, kAbove * line_m, 0), facing}, line_m, std::span(&name, 1));
    }
}

}  // namespace neuvv::headset

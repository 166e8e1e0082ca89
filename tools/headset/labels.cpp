#include "tools/headset/labels.h"

#include <fmt/format.h>

#include <algorithm>

namespace neuvv::headset {

namespace {

constexpr double kLine_rad = glm::radians(1.3);  // the height of a line, as it is seen
constexpr double kAbove = 0.7;                   // lines between the dot and the plate
constexpr double kNearer = 0.88;  // of the dot's distance, so that no body beside the dot covers the label

constexpr double kHintLine_rad = glm::radians(1.0), kHintAside_m = 0.11, kHintAbove_m = 0.02;

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

static_assert(std::size(kUses) <= std::tuple_size_v<decltype(ShownHints::lines)>);

}  // namespace

ButtonHints make_hints(const xr::Actions& actions, const HeadsetState& state) {
    ButtonHints hints;
    for (int role = 0; role < xr::kHands; role++)
        for (const ButtonUse& use : kUses)
            if (const std::string& name = actions.button_name(use.action, state.hand_of(role)); !name.empty())
                hints[role].push_back({use.button, fmt::format("{}: {}", name, use.use[role])});
    return hints;
}

ShownHints shown_hints(const HeadsetState& state, const Interaction& interaction, const ButtonHints& hints, int role) {
    ShownHints shown;
    if (!state.hints) return shown;
    for (const ButtonHint& hint : hints[role])
        if (interaction.panel || !(interaction.used_buttons[role].*hint.button)) shown.lines[shown.count++] = hint.text;
    return shown;
}

void draw_hints(xr::EyeShapes& shapes, const LabelFont& font, const HeadsetState& state, const Interaction& interaction,
                const ButtonHints& hints, const xr::Pose& world_head) {
    for (int role = 0; role < xr::kHands; role++) {
        const auto& grip = interaction.hands[role].grip;
        const auto [lines, count] = shown_hints(state, interaction, hints, role);
        const double distance_m = grip ? glm::distance(grip->position, world_head.position) : 0;
        if (count == 0 || distance_m < 0.05) continue;
        const glm::dquat facing = upright_towards((grip->position - world_head.position) / distance_m);
        const double outwards = state.hand_of(role) == xr::kLeft ? -1 : 1;
        const glm::dvec3 beside = facing * glm::dvec3(outwards * kHintAside_m, kHintAbove_m, 0);
        font.draw(shapes, {grip->position + beside, facing}, distance_m * kHintLine_rad, std::span(lines).first(count));
    }
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
    for (int which = 0; which < xr::kHands; which++) {
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

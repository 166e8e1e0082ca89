// Labels in the stage: the name of whom a ray hits, or the opening of what a hand holds, at the ray's end; what buttons
// do, at the controllers.
#pragma once

#include <functional>

#include "tools/headset/draw/label_font.h"
#include "tools/headset/hands/interaction.h"
#include "xr/actions.h"

namespace neuvv::headset {

// What stands at the end of a hand's ray: the name of the performer that it hits, or the opening of the light or camera
// that the hand holds; nothing where there is neither.
struct RayLabel {
    std::string text;
    double distance_m = 0;  // along the ray
};
std::optional<RayLabel> label_of_ray(const HeadsetState& state, const Interaction& interaction, int role);

// Adds the labels above the rays' ends, facing `world_head`. They are seen under the same angle from everywhere.
void draw_names(xr::EyeShapes& shapes, const LabelFont& font, const HeadsetState& state, const Interaction& interaction,
                const xr::Pose& world_head);

// What a button does, in a line such as "Trigger: select".
struct ButtonHint {
    bool UsedButtons::*button;
    std::string text;
};
// By role of the hand. A button without a name has no line.
using ButtonHints = std::array<std::vector<ButtonHint>, xr::kHands>;
ButtonHints make_hints(const xr::Actions& actions, const HeadsetState& state);
// Those of the hand with this role. What a long press of the select button does is said where the hand has no button
// for grabbing, and where neither hand has one for the panel. `name_of` gives the name of the button that this hand, or
// the other one, has for an action; empty where it has none.
using ButtonName = std::function<std::string(xr::HandAction, int role)>;
std::vector<ButtonHint> hints_of(int role, const ButtonName& name_of);

// The hints that are shown for the hand with this role: those of buttons that the user has not used since the program
// began, and all while the panel is visible. Bare hands without buttons have those of a pinch. None where
// HeadsetState::hints is off. They are as valid as `hints`.
struct ShownHints {
    std::array<std::string_view, 10> lines;
    size_t count = 0;
};
ShownHints shown_hints(const HeadsetState& state, const Interaction& interaction, const ButtonHints& hints, int role);

// The pose of the plate with the hints of a hand, which has a grip or an aim; facing `world_head`. `outwards` is 1 for
// the right hand, −1 for the left one. `is_new`: the user has used no button of it yet.
xr::Pose hint_plate(const Hand& hand, const xr::Pose& world_head, double outwards, bool is_new);

// Adds a plate with lines at the lower edge of the view: what is going on, where it is to be seen without the panel.
void draw_status(xr::EyeShapes& shapes, const LabelFont& font, std::span<const std::string> lines,
                 const xr::Pose& world_head);

// Adds plates with hints beside the controllers, on the outer side of each and facing `world_head`. As long as the user
// has used no button of a hand that is out of view, its plate is at the edge of the view on that side: users learn what
// buttons do before they raise their hands.
void draw_hints(xr::EyeShapes& shapes, const LabelFont& font, const HeadsetState& state, const Interaction& interaction,
                const ButtonHints& hints, const xr::Pose& world_head);

}  // namespace neuvv::headset

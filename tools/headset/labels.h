// Labels in the stage: the name of whom a ray hits, or the opening of what a hand holds, at the ray's end; what buttons
// do, at the controllers.
#pragma once

#include "tools/headset/interaction.h"
#include "tools/headset/label_font.h"
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

// The hints that are shown for the hand with this role: those of buttons that the user has not used since the program
// began, and all while the panel is visible. None where HeadsetState::hints is off. They are as valid as `hints`.
struct ShownHints {
    std::array<std::string_view, 8> lines;
    size_t count = 0;
};
ShownHints shown_hints(const HeadsetState& state, const Interaction& interaction, const ButtonHints& hints, int role);

// Adds plates with hints beside the controllers, on the outer side of each and facing `world_head`.
void draw_hints(xr::EyeShapes& shapes, const LabelFont& font, const HeadsetState& state, const Interaction& interaction,
                const ButtonHints& hints, const xr::Pose& world_head);

}  // namespace neuvv::headset

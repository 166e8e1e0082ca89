// A brush with a spherical tip on a performer's surface, and the edits that tools make of selected leaves. The returned
// edits have no frames, unless a comment says otherwise: at_frames gives them the frames at which they apply.
#pragma once

#include "edit/select.h"
#include "render/volume/pick.h"

namespace neuvv::edit {

struct Brush {
    float radius_m = 0.03f;             // metres, performer's space
    float hardness = 0.7f;              // the share of the radius that is fully painted; beyond it paint fades
    glm::vec3 colour{1, 0, 0};          // linear
    float alpha = 1;                    // 0: no colour
    float sigma = voctree::kKeepSigma;  // 1/m, for leaves of which the brush covers 1/2 or more
};

// The surface along one ray of a stroke: from where the ray has gathered the first of its alpha to where it has
// gathered nearly all of it.
struct Touch {
    glm::vec3 front, back;  // performer's space, metres
};

// The touches along a line through these pixels, one ray per pixel of its length. Rays that miss the performer as the
// picker shows it give no touch. The camera is in the performer's space.
std::vector<Touch> touches_under(render::Picker& picker, const stage::Camera& camera,
                                 std::span<const glm::dvec2> pixels);

// The edits of a stroke through the touches, for leaves with σ > 0; `sigma` is densities(). Everything between front
// and back is painted, so that what a pixel shows is painted even where the surface is soft. Neighbouring touches that
// are more than two radii apart are not joined: the surface ended between them.
std::vector<voctree::LeafEdit> stroke(const Canvas& canvas, std::span<const float> sigma, const Brush& brush,
                                      std::span<const Touch> touches);

// The same edit for every leaf: a colour (linear), or a density (1/m).
std::vector<voctree::LeafEdit> fill_leaves(std::span<const uint32_t> leaves, glm::vec3 colour, float alpha);
std::vector<voctree::LeafEdit> set_density(std::span<const uint32_t> leaves, float sigma);
inline std::vector<voctree::LeafEdit> erase_leaves(std::span<const uint32_t> leaves) {
    return set_density(leaves, 0);
}

// Turns the hue of a colour and multiplies its saturation. The luminance stays, and saturation is limited so that all
// channels stay within 0 to 1.
struct ColourShift {
    float hue_degrees = 0, saturation = 1;
};
glm::vec3 shifted(glm::vec3 colour, const ColourShift& shift);
// Each leaf's mean colours from frame `first` to frame `last`, shifted, as edits with their frames. A leaf that is
// empty in between gets no edits.
std::vector<voctree::LeafEdit> shift_colours(const Canvas& canvas, std::span<const uint32_t> leaves, float first,
                                             float last, const ColourShift& shift);

}  // namespace neuvv::edit

// A sphere-tipped brush on a performer's surface, and what a tool makes of chosen leaves. Edits come without frames,
// where it is not said otherwise: at_frames says when they hold.
#pragma once

#include "edit/select.h"
#include "render/pick.h"

namespace neuvv::edit {

struct Brush {
    float radius_m = 0.03f;             // performer's metres
    float hardness = 0.7f;              // the part of the radius that is painted whole; beyond it paint fades
    glm::vec3 colour{1, 0, 0};          // linear
    float alpha = 1;                    // 0: no colour
    float sigma = voctree::kKeepSigma;  // of leaves that the brush covers by half or more
};

// What a ray of a stroke shows lies between these: where it has gathered the first of its alpha, and nearly all.
struct Touch {
    glm::vec3 front, back;  // performer's space, metres
};

// Along a line over the image, a ray a pixel: those that meet the performer as the picker shows it. The camera in the
// performer's space.
std::vector<Touch> touches_under(render::Picker& picker, const stage::Camera& camera,
                                 std::span<const glm::dvec2> pixels);

// A stroke through touches, over leaves that are there (σ > 0): `sigma` as densities() has it. All between front and
// back is painted, so that what a pixel shows is, however soft the surface. Neighbouring touches farther apart than two
// radii are not joined: the surface ended between them.
std::vector<voctree::LeafEdit> stroke(const Canvas& canvas, std::span<const float> sigma, const Brush& brush,
                                      std::span<const Touch> touches);

// Every leaf the same: a colour, or a density.
std::vector<voctree::LeafEdit> fill_leaves(std::span<const uint32_t> leaves, glm::vec3 colour, float alpha);
std::vector<voctree::LeafEdit> set_density(std::span<const uint32_t> leaves, float sigma);
inline std::vector<voctree::LeafEdit> erase_leaves(std::span<const uint32_t> leaves) {
    return set_density(leaves, 0);
}

// A colour's hue turned, its saturation multiplied (about its luminance, which stays as far as there is room).
struct ColourShift {
    float hue_degrees = 0, saturation = 1;
};
glm::vec3 shifted(glm::vec3 colour, const ColourShift& shift);
// Each leaf's own mean colours from first to last, shifted, with the frames at which it has them; where it is not there
// at any frame between, nothing.
std::vector<voctree::LeafEdit> shift_colours(const Canvas& canvas, std::span<const uint32_t> leaves, float first,
                                             float last, const ColourShift& shift);

}  // namespace neuvv::edit

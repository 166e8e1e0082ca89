// Gaussian splats (Kerbl et al. 2023): what a clip shows at one of its frames in the form that most programs read.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "shared/hh_counts.h"
#include "slice/slice.h"

namespace neuvv::interchange {

// Colour by direction: 0.5 + Σ k_lm Y_lm(d), sRGB-encoded, for a unit direction d from the camera to the splat. Y_lm
// are real spherical harmonics with the Condon-Shortley phase, polar axis z, index l² + l + m, as splats have them.
using SplatColour = std::array<glm::vec3, kMaxShCount>;

// Renderers leave out splats and pixels of splats that are fainter.
constexpr float kFaintestOpacity = 1 / 255.0f;

// A Gaussian: its opacity falls by exp(−½ x²) at x standard deviations from the centre.
struct Splat {
    glm::vec3 centre{0};             // metres
    glm::quat rotation{1, 0, 0, 0};  // of its own axes
    glm::vec3 deviation{0};          // standard deviations along them, metres
    float opacity = 0;               // 0 to 1, where a ray goes through the centre
    SplatColour colour{};            // those of higher degrees than the splats' are 0
    uint32_t row = 0;                // in the file that it was read from
};

struct Splats {
    uint32_t degree = 0;  // of their harmonics
    std::vector<Splat> splats;
};

// How a leaf of edges e and mean optical depth τ along them becomes a splat: its deviations are `width` · e, its
// opacity 1 − exp(−`density` · τ). The defaults are about what trained clips are fitted to.
struct SplatShape {
    double width = 0.33, density = 0.6;
};

// Their axes are those of the clip's box. `rotation`: of the splats about the origin, with their axes and colours.
Splats splats_of(const slice::Slice& volume, const SplatShape& shape, const glm::dquat& rotation = {1, 0, 0, 0});

// Turns splats about the origin, with their axes and colours.
void turn(Splats& splats, const glm::dquat& rotation);

// Gives splats that were made of a volume another shape.
void reshape(Splats& splats, const slice::Slice& volume, const SplatShape& shape);

}  // namespace neuvv::interchange

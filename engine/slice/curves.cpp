#include "slice/curves.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "media/srgb.h"
#include "slice/slice.h"

namespace neuvv::slice {

namespace {

// Colours and opacities that are coded as 0 or 1 are a little more or less.
constexpr float kMargin = 0.5f / stream::kUnit;
constexpr float kLeastSlope = 0.02f;

float linear_of(float srgb) {
    return static_cast<float>(media::linear_from_srgb(double{srgb}));
}

}  // namespace

float slope_of(float srgb, uint32_t l) {
    const float linear = linear_of(srgb);
    const float curve = linear <= 0.0031308f ? 12.92f : 1.055f / 2.4f * std::pow(linear, 1 / 2.4f - 1);
    const float largest = std::sqrt((2.0f * static_cast<float>(l) + 1) / (4 * std::numbers::pi_v<float>));
    return std::max(curve * linear * (1 - linear), kLeastSlope) * largest;
}

float optical_depth_of(int16_t opacity) {
    static const std::vector<float> kDepths = [] {
        std::vector<float> depths;
        for (int units = 0; units <= stream::kUnit; ++units)
            depths.push_back(-std::log(1 - std::min(static_cast<float>(units) / stream::kUnit, 1 - kMargin)));
        return depths;
    }();
    return kDepths[static_cast<size_t>(opacity)];
}

std::vector<float> sigmas_of(uint32_t depth, glm::vec3 box_size) {
    std::vector<float> sigmas((depth + 1) * kOpacities);
    for (uint32_t d = 1; d <= depth; ++d)
        for (size_t opacity = 0; opacity < kOpacities; ++opacity)
            sigmas[d * kOpacities + opacity] = sigma_of(static_cast<int16_t>(opacity), edge_m(box_size, d));
    return sigmas;
}

const ColourCurves& colour_curves() {
    static const ColourCurves kCurves = [] {
        ColourCurves curves;
        for (size_t half = 0; half < kColourHalves; ++half) {
            const float srgb = std::clamp(static_cast<float>(half) / (2 * stream::kUnit), kMargin, 1 - kMargin);
            const float linear = linear_of(srgb);
            curves.constant[half] = std::log(linear / (1 - linear)) / kMeanHarmonic;
            for (uint32_t l = 0; l < curves.per_unit.size(); ++l)
                curves.per_unit[l][half] = 1 / (stream::kUnit * slope_of(srgb, l));
        }
        return curves;
    }();
    return kCurves;
}

}  // namespace neuvv::slice

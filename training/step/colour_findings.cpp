#include "training/step/colour_findings.h"

#include <algorithm>
#include <cmath>

namespace neuvv::training {

double largest_gain_error(const CameraColours& colours, size_t camera) {
    const glm::vec3 error = glm::abs(gains(colours.values[camera]) - 1.0f);
    return double{std::max({error.r, error.g, error.b})};
}

double exposure_error(const CameraColours& colours, size_t camera) {
    const size_t frames = colours.frames();
    double squares = 0;
    for (size_t frame = 0; frame < frames; ++frame) {
        const double exposure = double{colours.exposures.values[camera * frames + frame]};
        squares += exposure * exposure;
    }
    return frames > 0 ? std::sqrt(squares / static_cast<double>(frames)) : 0;
}

double missing_at_corners(const CameraColours& colours, size_t camera) {
    const std::vector<float>& numbers = colours.vignettes.values;
    if (numbers.empty()) return 0;
    return 1 - double{vignette_at({numbers[2 * camera], numbers[2 * camera + 1]}, 1)};
}

ColourRefinement worthwhile(const CameraColours& colours) {
    ColourRefinement what;
    double squares = 0;
    for (size_t camera = 0; camera < colours.cameras(); ++camera) {
        what.colour |= largest_gain_error(colours, camera) > kWorthGain;
        what.vignetting |= std::abs(missing_at_corners(colours, camera)) > kWorthVignetting;
        squares += std::pow(exposure_error(colours, camera), 2);
    }
    what.exposure = squares > std::pow(kWorthExposure, 2) * static_cast<double>(colours.cameras());
    return what;
}

}  // namespace neuvv::training

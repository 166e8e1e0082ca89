#include "voctree/decode_colours.h"

#include <algorithm>
#include <cmath>

#include "base/sigmoid.h"
#include "media/image.h"
#include "voctree/sh_weights.h"

namespace neuvv::voctree {

namespace {

// Beyond ± this logit sRGB is a straight line of linear light, so that the curve runs at a constant distance from the
// identity.
constexpr double kLastLogit = 20;
constexpr int kStepsPerLogit = 128;

}  // namespace

ColourDecoder::ColourDecoder(uint32_t degree) : functions_(sh_count(degree)) {
    for (int i = 0; i <= 2 * kLastLogit * kStepsPerLogit; ++i) {
        const double linear = media::linear_from_srgb(sigmoid(static_cast<double>(i) / kStepsPerLogit - kLastLogit));
        curve_.push_back(std::log(linear / (1 - linear)));
    }
    for (const ShDirection& direction : sh_directions()) {
        basis_.push_back(sh_basis(direction.d));
        weights_.push_back(direction.weight);
    }
}

double ColourDecoder::decoded_logit(double logit) const {
    const double clamped = std::clamp(logit, -kLastLogit, kLastLogit);
    const double at = (clamped + kLastLogit) * kStepsPerLogit;
    const size_t step = std::min(static_cast<size_t>(at), curve_.size() - 2);
    const double share = at - static_cast<double>(step);
    return (1 - share) * curve_[step] + share * curve_[step + 1] + (logit - clamped);
}

ChannelSh ColourDecoder::decode(const ChannelSh& k) const {
    ChannelSh decoded{};
    for (size_t i = 0; i < basis_.size(); ++i) {
        double logit = 0;
        for (size_t j = 0; j < functions_; ++j) logit += k[j] * basis_[i][j];
        const double weighted = weights_[i] * decoded_logit(logit);
        for (size_t j = 0; j < functions_; ++j) decoded[j] += weighted * basis_[i][j];
    }
    return decoded;
}

}  // namespace neuvv::voctree

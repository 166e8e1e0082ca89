#include "voctree/decode_colours.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "media/image.h"

namespace neuvv::voctree {

namespace {

// Beyond ± this logit sRGB is a straight line of linear light, so that the curve runs at a constant distance from the
// identity.
constexpr double kLastLogit = 20;
constexpr int kStepsPerLogit = 128;

double sigmoid(double logit) {
    return 1 / (1 + std::exp(-logit));
}

ChannelSh sh_basis(glm::dvec3 d) {
    return {0.28209479177387814,
            0.4886025119029199 * d.y,
            0.4886025119029199 * d.z,
            0.4886025119029199 * d.x,
            1.0925484305920792 * d.x * d.y,
            1.0925484305920792 * d.y * d.z,
            0.31539156525252005 * (3 * d.z * d.z - 1),
            1.0925484305920792 * d.x * d.z,
            0.5462742152960396 * (d.x * d.x - d.y * d.y),
            0.5900435899266435 * d.y * (3 * d.x * d.x - d.y * d.y),
            2.890611442640554 * d.x * d.y * d.z,
            0.4570457994644658 * d.y * (5 * d.z * d.z - 1),
            0.3731763325901154 * d.z * (5 * d.z * d.z - 3),
            0.4570457994644658 * d.x * (5 * d.z * d.z - 1),
            1.445305721320277 * d.z * (d.x * d.x - d.y * d.y),
            0.5900435899266435 * d.x * (d.x * d.x - 3 * d.y * d.y)};
}

}  // namespace

ColourDecoder::ColourDecoder(uint32_t degree) : functions_(sh_count(degree)) {
    for (int i = 0; i <= 2 * kLastLogit * kStepsPerLogit; ++i) {
        const double linear = media::linear_from_srgb(sigmoid(static_cast<double>(i) / kStepsPerLogit - kLastLogit));
        curve_.push_back(std::log(linear / (1 - linear)));
    }
    for (int i = 0; i < 27; ++i) {
        const glm::dvec3 cell(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const double squared = glm::dot(cell, cell);  // 1: along an axis, 2: to an edge, 3: to a corner of the cube
        if (squared == 0) continue;
        basis_.push_back(sh_basis(cell / std::sqrt(squared)));
        weights_.push_back(4 * std::numbers::pi * (squared == 1 ? 1.0 / 21 : squared == 2 ? 4.0 / 105 : 9.0 / 280));
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

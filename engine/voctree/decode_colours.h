// Colours as a display is sent them, decoded to linear light while they are still SH under a sigmoid.
#pragma once

#include <array>
#include <vector>

#include "shared/hh_counts.h"

namespace neuvv::voctree {

// One channel's coefficients, index l² + l + m (sh.glsl); those beyond the degree are 0.
using ChannelSh = std::array<double, kMaxShCount>;

// What sigmoid(Σ k_lm Y_lm(d)) shows as sRGB, as k'_lm whose sigmoid is linear light. Without dependence on d exact (to
// 1e-5 of the logit); else the logit that is wanted is projected onto SH by 26 directions, which are exact for
// polynomials of degree 7 (Lebedev); sRGB is off by 0.002 in the mean where other coefficients are a fifth of the first
// (plenoctree_test).
class ColourDecoder {
  public:
    explicit ColourDecoder(uint32_t degree);
    ChannelSh decode(const ChannelSh& k) const;

  private:
    uint32_t functions_;
    std::vector<double> curve_;     // by logit
    std::vector<ChannelSh> basis_;  // Y by direction
    std::vector<double> weights_;   // of directions, 4π in sum

    double decoded_logit(double logit) const;
};

}  // namespace neuvv::voctree

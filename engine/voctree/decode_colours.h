// Decodes sRGB colours that are given as the sigmoid of SH into linear light in the same form.
#pragma once

#include <array>
#include <vector>

#include "shared/hh_counts.h"

namespace neuvv::voctree {

// The SH coefficients of one colour channel, index l² + l + m (sh.glsl); those beyond the degree are 0.
using ChannelSh = std::array<double, kMaxShCount>;

// From coefficients k_lm, where sigmoid(Σ k_lm Y_lm(d)) is sRGB, to k'_lm, where sigmoid(Σ k'_lm Y_lm(d)) is the same
// colour in linear light. A colour that is the same from all directions d is decoded exactly (to 1e-5 of the logit).
// Otherwise the logits of linear light in 26 directions are projected onto SH; as a quadrature these directions are
// exact for polynomials of degree 7 (Lebedev). The mean error is 0.002 in sRGB where other coefficients are a fifth of
// the first (plenoctree_test).
class ColourDecoder {
  public:
    explicit ColourDecoder(uint32_t degree);
    ChannelSh decode(const ChannelSh& k) const;

  private:
    uint32_t functions_;
    std::vector<double> curve_;     // the logit of linear light by the logit of sRGB, at equal steps
    std::vector<ChannelSh> basis_;  // Y_lm in each of the 26 directions
    std::vector<double> weights_;   // quadrature weights of the directions; their sum is 4π

    double decoded_logit(double logit) const;
};

}  // namespace neuvv::voctree

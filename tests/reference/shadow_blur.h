// The low-pass of a light's view of the performers, in double precision (errata 15).
#pragma once

#include <cstdint>
#include <vector>

namespace neuvv::reference {

struct ShadowTexel {
    double alpha = 0;
    double metres = 0;  // undefined where alpha is 0
};

// A square image, row by row. Each texel becomes the mean, by a Gaussian in two dimensions, of those at most
// kBlurRadius texels away along each axis; beyond the edge nothing is. Metres are means weighted by alpha, too.
std::vector<ShadowTexel> blurred_shadow(const std::vector<ShadowTexel>& texels, uint32_t side);

}  // namespace neuvv::reference

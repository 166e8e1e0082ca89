#include "reference/shadow_blur.h"

#include <cmath>

#include "shared/shadow_blur.h"

namespace neuvv::reference {

namespace {

double gaussian(int x, int y) {
    return std::exp(-0.5 * (x * x + y * y) / (double{kBlurSigma} * double{kBlurSigma}));
}

}  // namespace

std::vector<ShadowTexel> blurred_shadow(const std::vector<ShadowTexel>& texels, uint32_t side) {
    constexpr int kRadius = kBlurRadius;
    const int edge = static_cast<int>(side);
    std::vector<ShadowTexel> blurred(texels.size());
    for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x) {
            double weights = 0, alpha = 0, metres = 0;
            for (int v = y - kRadius; v <= y + kRadius; ++v)
                for (int u = x - kRadius; u <= x + kRadius; ++u) {
                    const double weight = gaussian(u - x, v - y);
                    weights += weight;
                    if (u < 0 || v < 0 || u >= edge || v >= edge) continue;
                    const ShadowTexel& texel = texels[static_cast<size_t>(v * edge + u)];
                    if (texel.alpha <= 0) continue;
                    alpha += weight * texel.alpha;
                    metres += weight * texel.alpha * texel.metres;
                }
            blurred[static_cast<size_t>(y * edge + x)] = {alpha / weights, alpha > 0 ? metres / alpha : 0};
        }
    return blurred;
}

}  // namespace neuvv::reference

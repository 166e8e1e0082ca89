#include "training/evaluation/metrics.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include "media/psnr.h"
#include "training/evaluation/flip.h"

namespace neuvv::training {

namespace {

constexpr uint32_t kWindow = 11;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // (K L)², L = 1
constexpr double kErrorWhite = 0.25;

// The window along a side of `size` pixels: 11 taps, or fewer where there are fewer pixels, around the centre.
std::vector<double> window_taps(uint32_t size) {
    std::vector<double> taps(std::min(kWindow, size));
    double sum = 0;
    for (size_t i = 0; i < taps.size(); ++i) {
        const double d = static_cast<double>(i) - 0.5 * (static_cast<double>(taps.size()) - 1);
        sum += taps[i] = std::exp(-d * d / (2 * kSigma * kSigma));
    }
    for (double& tap : taps) tap /= sum;
    return taps;
}

// Weighted means over a window: of a, b, a² + b² and ab. SSIM needs only these, as its variances occur only as a sum.
using WindowMoments = std::array<double, 4>;

double ssim_of(const WindowMoments& m) {
    const double mean_product = m[0] * m[1], mean_squares = m[0] * m[0] + m[1] * m[1];
    const double covariance = m[3] - mean_product, variances = m[2] - mean_squares;
    return (2 * mean_product + kC1) * (2 * covariance + kC2) / ((mean_squares + kC1) * (variances + kC2));
}

// One row's moments, filtered along x.
void filter_row(const uint8_t* a, const uint8_t* b, const std::vector<double>& taps,
                std::vector<WindowMoments>& products, std::vector<WindowMoments>& out) {
    for (size_t x = 0; x < products.size(); ++x) {
        const double p = a[4 * x] / 255.0, q = b[4 * x] / 255.0;
        products[x] = {p, q, p * p + q * q, p * q};
    }
    for (size_t x = 0; x < out.size(); ++x) {
        WindowMoments sum{};
        for (size_t k = 0; k < taps.size(); ++k)
            for (size_t m = 0; m < 4; ++m) sum[m] += taps[k] * products[x + k][m];
        out[x] = sum;
    }
}

// Mean SSIM of one channel. The filter is separable: a ring buffer has as many rows filtered along x as the window is
// high.
double mean_ssim(const media::Image& truth, const media::Image& result, size_t channel) {
    const std::vector<double> taps_x = window_taps(truth.width), taps_y = window_taps(truth.height);
    const size_t columns = truth.width - taps_x.size() + 1, rows = truth.height - taps_y.size() + 1;
    std::vector<WindowMoments> products(truth.width);
    std::vector<std::vector<WindowMoments>> ring(taps_y.size(), std::vector<WindowMoments>(columns));
    std::vector<WindowMoments> sums(columns);
    double total = 0;
    for (uint32_t y = 0; y < truth.height; ++y) {
        filter_row(truth.at(0, y) + channel, result.at(0, y) + channel, taps_x, products, ring[y % ring.size()]);
        if (y + 1 < taps_y.size()) continue;
        std::fill(sums.begin(), sums.end(), WindowMoments{});
        for (size_t k = 0; k < taps_y.size(); ++k) {
            const std::vector<WindowMoments>& row = ring[(y + 1 + k) % ring.size()];  // oldest first
            for (size_t x = 0; x < columns; ++x)
                for (size_t m = 0; m < 4; ++m) sums[x][m] += taps_y[k] * row[x][m];
        }
        for (const WindowMoments& moments : sums) total += ssim_of(moments);
    }
    return total / static_cast<double>(columns * rows);
}

}  // namespace

Quality compare(const media::Image& truth, const media::Image& result) {
    assert(truth.width == result.width && truth.height == result.height && "images to compare have one size");
    assert(truth.width > 0 && truth.height > 0 && "images to compare have pixels");
    uint64_t absolute = 0;
    for (size_t i = 0; i < truth.rgba.size(); ++i)
        if (i % 4 != 3) absolute += static_cast<uint64_t>(std::abs(int{truth.rgba[i]} - int{result.rgba[i]}));
    Quality quality;
    quality.psnr = media::psnr_db(truth, result);
    quality.mae = static_cast<double>(absolute) / (3.0 * truth.width * truth.height * 255);
    for (size_t c = 0; c < 3; ++c) quality.ssim += mean_ssim(truth, result, c) / 3;
    quality.flip = mean_of(flip(truth, result));
    return quality;
}

media::Image error_image(const media::Image& truth, const media::Image& result) {
    assert(truth.width == result.width && truth.height == result.height && "images to compare have one size");
    media::Image error(truth.width, truth.height);
    for (size_t i = 0; i < error.rgba.size(); ++i) {
        const int difference = std::abs(int{truth.rgba[i]} - int{result.rgba[i]});
        error.rgba[i] = i % 4 == 3 ? 255 : static_cast<uint8_t>(std::min(255.0, std::round(difference / kErrorWhite)));
    }
    return error;
}

}  // namespace neuvv::training

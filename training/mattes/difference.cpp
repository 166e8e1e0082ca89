#include "training/mattes/difference.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "training/mattes/soft_edges.h"

namespace neuvv::training {

namespace {

constexpr double kSigmaOfMad = 1.4826;  // standard deviation / median absolute deviation of a normal distribution
constexpr double kMinSigma = 1;         // steps of 255: rounding to 8 bits, and a little noise

// The value of rank `rank` in a histogram that begins at `first`.
int value_of_rank(const std::vector<uint64_t>& histogram, int first, uint64_t rank) {
    uint64_t below = 0;
    for (size_t i = 0; i < histogram.size(); ++i)
        if ((below += histogram[i]) > rank) return first + static_cast<int>(i);
    return first + static_cast<int>(histogram.size()) - 1;
}

// How an image of the background differs from the background, in steps of 255: by a constant, and noise around it.
struct Noise {
    int offset = 0;
    double sigma = kMinSigma;
};

Noise noise_of_channel(const media::Image& image, const media::Image& background, size_t channel) {
    std::vector<uint64_t> differences(511), deviations(511);
    const uint64_t pixels = image.rgba.size() / 4;
    const auto difference = [&](size_t i) { return int{image.rgba[i]} - int{background.rgba[i]}; };
    for (size_t i = channel; i < image.rgba.size(); i += 4) ++differences[static_cast<size_t>(difference(i) + 255)];
    Noise noise;
    noise.offset = value_of_rank(differences, -255, pixels / 2);
    for (int d = -255; d <= 255; ++d)
        deviations[std::min<size_t>(static_cast<size_t>(std::abs(d - noise.offset)), 510)] +=
            differences[static_cast<size_t>(d + 255)];
    noise.sigma = std::max(kMinSigma, kSigmaOfMad * value_of_rank(deviations, 0, pixels / 2));
    return noise;
}

// Per pixel the largest difference of a channel, in units of the channel's noise.
std::vector<float> differences_in_noise(const media::Image& image, const media::Image& background) {
    std::array<Noise, 3> noise;
    for (size_t c = 0; c < 3; ++c) noise[c] = noise_of_channel(image, background, c);
    std::vector<float> result(image.rgba.size() / 4);
    for (size_t i = 0; i < result.size(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            const int d = int{image.rgba[4 * i + c]} - int{background.rgba[4 * i + c]} - noise[c].offset;
            result[i] = std::max(result[i], static_cast<float>(std::abs(d) / noise[c].sigma));
        }
    return result;
}

// The pixels that differ by more than `high`, and those connected to them that differ by more than `low`.
PixelMask hysteresis(const std::vector<float>& differences, uint32_t width, uint32_t height, float low, float high) {
    PixelMask mask(width, height);
    std::vector<size_t> open;
    for (size_t i = 0; i < differences.size(); ++i)
        if (differences[i] > high) {
            mask.set[i] = 1;
            open.push_back(i);
        }
    while (!open.empty()) {
        const size_t at = open.back();
        open.pop_back();
        for_each_neighbour(mask, at, true, [&](size_t next) {
            if (mask.set[next] || differences[next] <= low) return;
            mask.set[next] = 1;
            open.push_back(next);
        });
    }
    return mask;
}

}  // namespace

PixelMask differing_pixels(const media::Image& image, const media::Image& background, const MatteSettings& settings) {
    assert(image.width == background.width && image.height == background.height && "images have one size");
    const std::vector<float> differences = differences_in_noise(image, background);
    const auto high = static_cast<float>(settings.threshold);
    const PixelMask mask =
        hysteresis(differences, image.width, image.height, high * static_cast<float>(settings.low_share), high);
    const auto pixels = static_cast<double>(mask.size());
    const PixelMask filled = inverse(without_specks(inverse(mask), static_cast<size_t>(settings.hole_share * pixels)));
    return without_specks(filled, static_cast<size_t>(settings.speck_share * pixels));
}

std::vector<uint8_t> difference_matte(const media::Image& image, const media::Image& background,
                                      const MatteSettings& settings) {
    return soft_edges(image, differing_pixels(image, background, settings), background);
}

}  // namespace neuvv::training

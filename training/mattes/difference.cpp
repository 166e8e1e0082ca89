#include "training/mattes/difference.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/glm.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "training/mattes/shadows.h"
#include "training/mattes/soft_edges.h"

namespace neuvv::training {

namespace {

constexpr double kSigmaOfMad = 1.4826;  // standard deviation / median absolute deviation of a normal distribution
constexpr double kMinSigma = 1;         // steps of 255: rounding to 8 bits, and a little noise

// Lossy compression, sharpening and lenses leave errors so near to an edge (pixels: a block of JPEG), of about this
// share of its contrast. Without them, fringes of the background would belong to the performer.
constexpr int kEdgeReach = 8;
constexpr float kEdgeError = 0.01f;

// Pixels that differ by less show the background.
float low_threshold(const MatteSettings& settings) {
    return static_cast<float>(settings.threshold * settings.low_share);
}

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

using NoiseOfChannels = std::array<Noise, 3>;

// The pixel of the image without the constant difference, that of the background, by channel.
std::pair<glm::vec3, glm::vec3> colours_at(const media::Image& image, const media::Image& background,
                                           const NoiseOfChannels& noise, size_t pixel) {
    std::pair<glm::vec3, glm::vec3> colours;
    for (size_t c = 0; c < 3; ++c) {
        colours.first[static_cast<int>(c)] = static_cast<float>(int{image.rgba[4 * pixel + c]} - noise[c].offset);
        colours.second[static_cast<int>(c)] = background.rgba[4 * pixel + c];
    }
    return colours;
}

// By how much the lightest and the darkest grey near each pixel differ, in steps of 255.
std::vector<float> contrast_near(const media::Image& image) {
    const auto width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    const cv::Mat rgba(height, width, CV_8UC4, const_cast<uint8_t*>(image.rgba.data()));
    cv::Mat grey, lightest, darkest;
    cv::cvtColor(rgba, grey, cv::COLOR_RGBA2GRAY);
    const cv::Mat near = cv::getStructuringElement(cv::MORPH_RECT, {2 * kEdgeReach + 1, 2 * kEdgeReach + 1});
    cv::dilate(grey, lightest, near);
    cv::erode(grey, darkest, near);
    const cv::Mat contrast = lightest - darkest;
    return {contrast.begin<uint8_t>(), contrast.end<uint8_t>()};
}

// What differs, by channel, in units of the channel's noise and of the errors of edges.
std::array<float, 3> in_noise(const glm::vec3& difference, const NoiseOfChannels& noise, float contrast) {
    std::array<float, 3> result{};
    for (size_t c = 0; c < 3; ++c)
        result[c] = difference[static_cast<int>(c)] / (static_cast<float>(noise[c].sigma) + kEdgeError * contrast);
    return result;
}

float largest(const std::array<float, 3>& differences) {
    return std::max({std::abs(differences[0]), std::abs(differences[1]), std::abs(differences[2])});
}

// How the pixels compare with a plate's.
std::vector<Shade> shades_of(const media::Image& image, const media::Image& plate, const NoiseOfChannels& noise,
                             const std::vector<float>& contrast) {
    std::vector<Shade> shades(contrast.size());
    for (size_t i = 0; i < shades.size(); ++i) {
        const auto [seen, behind] = colours_at(image, plate, noise, i);
        shades[i].light = glm::dot(seen, behind) / std::max(glm::dot(behind, behind), 1.0f);
        shades[i].hue = in_noise(seen - shades[i].light * behind, noise, contrast[i]);
    }
    return shades;
}

// By pixel, the largest difference of a channel, in these units; where a shadow falls on a plate, that of hue.
std::vector<float> differences_in_noise(const media::Image& image, const media::Image& background, BackgroundKind kind,
                                        const MatteSettings& settings) {
    NoiseOfChannels noise;
    for (size_t c = 0; c < 3; ++c) noise[c] = noise_of_channel(image, background, c);
    std::vector<float> result(image.rgba.size() / 4);
    const bool is_plate = kind == BackgroundKind::kPlate;
    const std::vector<float> contrast = is_plate ? contrast_near(image) : std::vector<float>(result.size());
    PixelMask same(image.width, image.height);
    for (size_t i = 0; i < result.size(); ++i) {
        const auto [seen, behind] = colours_at(image, background, noise, i);
        result[i] = largest(in_noise(seen - behind, noise, contrast[i]));
        same.set[i] = result[i] <= low_threshold(settings);
    }
    if (!is_plate) return result;
    const std::vector<Shade> shades = shades_of(image, background, noise, contrast);
    const PixelMask shadows = soft_shadows(same, shades);
    for (size_t i = 0; i < result.size(); ++i)
        if (shadows[i]) result[i] = largest(shades[i].hue);
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

PixelMask differing_pixels(const media::Image& image, const media::Image& background, BackgroundKind kind,
                           const MatteSettings& settings) {
    assert(image.width == background.width && image.height == background.height && "images have one size");
    const std::vector<float> differences = differences_in_noise(image, background, kind, settings);
    const PixelMask mask = hysteresis(differences, image.width, image.height, low_threshold(settings),
                                      static_cast<float>(settings.threshold));
    const auto pixels = static_cast<double>(mask.size());
    const PixelMask filled = inverse(without_specks(inverse(mask), static_cast<size_t>(settings.hole_share * pixels)));
    return without_specks(filled, static_cast<size_t>(settings.speck_share * pixels));
}

std::vector<uint8_t> difference_matte(const media::Image& image, const media::Image& background, BackgroundKind kind,
                                      const MatteSettings& settings) {
    return soft_edges(image, differing_pixels(image, background, kind, settings), background);
}

}  // namespace neuvv::training

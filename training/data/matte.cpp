#include "training/data/matte.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/glm.hpp>

#include "base/threads/parallel.h"

namespace neuvv::training {

namespace {

constexpr double kSigmaOfMad = 1.4826;  // standard deviation / median absolute deviation of a normal distribution
constexpr double kMinSigma = 1;         // steps of 255: rounding to 8 bits, and a little noise
constexpr int kColourRadius = 2;        // pixels from an edge pixel within which the performer's colour is sought
constexpr float kMinContrast = 1e-4f;   // squared, linear: below it, two colours count as equal

// One byte per pixel: 1 where it is set.
struct Mask {
    int width, height;
    std::vector<uint8_t> set;

    Mask(uint32_t w, uint32_t h) : width(static_cast<int>(w)), height(static_cast<int>(h)), set(size_t{w} * h) {}
    size_t index(int x, int y) const {
        return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
    }
    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

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

template <typename Action>
void for_neighbours(const Mask& mask, size_t at, Action action) {
    const int x = static_cast<int>(at) % mask.width, y = static_cast<int>(at) / mask.width;
    for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u)
            if ((u != 0 || v != 0) && mask.inside(x + u, y + v)) action(mask.index(x + u, y + v));
}

// The pixels that differ by more than `high`, and those connected to them that differ by more than `low`.
Mask hysteresis(const std::vector<float>& differences, uint32_t width, uint32_t height, float low, float high) {
    Mask mask(width, height);
    std::vector<size_t> open;
    for (size_t i = 0; i < differences.size(); ++i)
        if (differences[i] > high) {
            mask.set[i] = 1;
            open.push_back(i);
        }
    while (!open.empty()) {
        const size_t at = open.back();
        open.pop_back();
        for_neighbours(mask, at, [&](size_t next) {
            if (mask.set[next] || differences[next] <= low) return;
            mask.set[next] = 1;
            open.push_back(next);
        });
    }
    return mask;
}

// The mask without the pixels at its border.
Mask shrunk(const Mask& mask) {
    Mask result = mask;
    for (size_t i = 0; i < mask.set.size(); ++i)
        for_neighbours(mask, i, [&](size_t next) { result.set[i] = std::min(result.set[i], mask.set[next]); });
    return result;
}

// Flips connected parts that have this value and at most `limit` pixels.
void drop_small_parts(Mask& mask, uint8_t value, size_t limit) {
    std::vector<uint8_t> seen(mask.set.size());
    std::vector<size_t> part;
    for (size_t start = 0; start < mask.set.size(); ++start) {
        if (seen[start] || mask.set[start] != value) continue;
        part.assign(1, start);
        seen[start] = 1;
        for (size_t i = 0; i < part.size(); ++i)
            for_neighbours(mask, part[i], [&](size_t next) {
                if (seen[next] || mask.set[next] != value) return;
                seen[next] = 1;
                part.push_back(next);
            });
        if (part.size() <= limit)
            for (const size_t i : part) mask.set[i] = 1 - value;
    }
}

glm::vec3 linear_colour(const media::Image& image, size_t pixel) {
    const uint8_t* rgb = &image.rgba[4 * pixel];
    return {media::linear_from_srgb_byte(rgb[0]), media::linear_from_srgb_byte(rgb[1]),
            media::linear_from_srgb_byte(rgb[2])};
}

// The share of an edge pixel that shows the performer. `inner` is the mask without its border.
float edge_alpha(const media::Image& image, const media::Image& background, const Mask& inner, size_t at) {
    const int x = static_cast<int>(at) % inner.width, y = static_cast<int>(at) / inner.width;
    glm::vec3 sum(0);
    float count = 0;
    for (int v = -kColourRadius; v <= kColourRadius; ++v)
        for (int u = -kColourRadius; u <= kColourRadius; ++u)
            if (inner.inside(x + u, y + v) && inner.set[inner.index(x + u, y + v)]) {
                sum += linear_colour(image, inner.index(x + u, y + v));
                ++count;
            }
    if (count == 0) return 1;  // a part that is all border, such as a hair, is opaque
    const glm::vec3 behind = linear_colour(background, at), towards = sum / count - behind;
    const float contrast = glm::dot(towards, towards);
    if (contrast < kMinContrast) return 1;
    return std::clamp(glm::dot(linear_colour(image, at) - behind, towards) / contrast, 0.0f, 1.0f);
}

}  // namespace

media::Image median_background(const std::vector<media::Image>& frames) {
    assert(!frames.empty() && "a median is of something");
    media::Image median(frames[0].width, frames[0].height);
    for (const media::Image& frame : frames) {
        assert(frame.rgba.size() == median.rgba.size() && "frames of one camera have one size");
        (void)frame;
    }
    parallel_for(median.rgba.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
        std::vector<uint8_t> values(frames.size());
        for (size_t i = begin; i < end; ++i) {
            for (size_t f = 0; f < frames.size(); ++f) values[f] = frames[f].rgba[i];
            const auto centre = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
            std::nth_element(values.begin(), centre, values.end());
            median.rgba[i] = i % 4 == 3 ? 255 : *centre;
        }
    });
    return median;
}

std::vector<uint8_t> difference_matte(const media::Image& image, const media::Image& background,
                                      const MatteSettings& settings) {
    assert(image.width == background.width && image.height == background.height && "images have one size");
    const std::vector<float> differences = differences_in_noise(image, background);
    const auto high = static_cast<float>(settings.threshold);
    Mask mask = hysteresis(differences, image.width, image.height, high * static_cast<float>(settings.low_share), high);
    const auto pixels = static_cast<double>(mask.set.size());
    drop_small_parts(mask, 0, static_cast<size_t>(settings.hole_share * pixels));
    drop_small_parts(mask, 1, static_cast<size_t>(settings.speck_share * pixels));
    const Mask inner = shrunk(mask);
    std::vector<uint8_t> alpha(mask.set.size());
    for (size_t i = 0; i < alpha.size(); ++i)
        if (inner.set[i])
            alpha[i] = 255;
        else if (mask.set[i])
            alpha[i] = static_cast<uint8_t>(std::lround(255 * edge_alpha(image, background, inner, i)));
    return alpha;
}

}  // namespace neuvv::training

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>

#include "render/set/raster.h"
#include "voctree/files/half.h"

namespace neuvv::render {

namespace {

uint8_t byte_of(float value) {
    return static_cast<uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
}

uint8_t srgb_byte(float linear) {
    return byte_of(static_cast<float>(media::srgb_from_linear(static_cast<double>(std::clamp(linear, 0.0f, 1.0f)))));
}

const std::array<float, 256>& linear_of_byte() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(media::linear_from_srgb(static_cast<double>(i) / 255));
        return values;
    }();
    return table;
}

// The mean of a 2×2 block, whose second row or column may be outside the image.
void shrink_pixel(const media::Image& from, uint32_t x, uint32_t y, uint8_t* to) {
    const auto& linear = linear_of_byte();
    glm::vec4 sum(0);
    glm::vec3 unweighted(0);
    for (uint32_t i = 0; i < 4; ++i) {
        const uint8_t* pixel =
            from.at(std::min(2 * x + i % 2, from.width - 1), std::min(2 * y + i / 2, from.height - 1));
        const glm::vec3 colour(linear[pixel[0]], linear[pixel[1]], linear[pixel[2]]);
        const float alpha = static_cast<float>(pixel[3]) / 255.0f;
        sum += glm::vec4(colour * alpha, alpha);
        unweighted += colour;
    }
    const glm::vec3 mean = sum.a > 0 ? glm::vec3(sum) / sum.a : unweighted / 4.0f;
    for (int c = 0; c < 3; ++c) to[c] = srgb_byte(mean[c]);
    to[3] = byte_of(sum.a / 4);
}

// The same for numbers: the mean of each channel by itself.
void shrink_numbers(const media::Image& from, uint32_t x, uint32_t y, uint8_t* to) {
    for (int c = 0; c < 4; ++c) {
        int sum = 2;
        for (uint32_t i = 0; i < 4; ++i)
            sum += from.at(std::min(2 * x + i % 2, from.width - 1), std::min(2 * y + i / 2, from.height - 1))[c];
        to[c] = static_cast<uint8_t>(sum / 4);
    }
}

using ShrinkPixel = void (*)(const media::Image& from, uint32_t x, uint32_t y, uint8_t* to);

std::vector<std::vector<uint8_t>> levels_by(const media::Image& image, ShrinkPixel shrink) {
    std::vector<std::vector<uint8_t>> levels{{image.rgba.begin(), image.rgba.end()}};
    media::Image level = image;
    while (level.width > 1 || level.height > 1) {
        media::Image next(std::max(1u, level.width / 2), std::max(1u, level.height / 2));
        for (uint32_t y = 0; y < next.height; ++y)
            for (uint32_t x = 0; x < next.width; ++x) shrink(level, x, y, next.at(x, y));
        level = std::move(next);
        levels.emplace_back(level.rgba.begin(), level.rgba.end());
    }
    return levels;
}

}  // namespace

std::vector<glm::vec4> box_down(const RasterImage& image, uint32_t width, uint32_t height) {
    const uint32_t columns = image.width * kSupersample, rows = image.height * kSupersample;
    assert(image.halves.size() == size_t{4} * columns * rows && "a supersampled image");
    assert(image.x + image.width <= width && image.y + image.height <= height && "a part of the image");
    std::vector<glm::vec4> out(size_t{width} * height, glm::vec4(0));
    constexpr float kShare = 1.0f / (kSupersample * kSupersample);
    for (uint32_t y = 0; y < rows; ++y)
        for (uint32_t x = 0; x < columns; ++x) {
            const uint16_t* pixel = &image.halves[(size_t{y} * columns + x) * 4];
            uint64_t bits = 0;
            std::memcpy(&bits, pixel, sizeof(bits));
            if (bits == 0) continue;  // true for most pixels
            glm::vec4& sum = out[size_t{image.y + y / kSupersample} * width + image.x + x / kSupersample];
            for (int c = 0; c < 4; ++c) sum[c] += kShare * voctree::float_from_half(pixel[c]);
        }
    return out;
}

media::Image encode_straight(std::span<const glm::vec4> premultiplied, uint32_t width, uint32_t height) {
    assert(premultiplied.size() == size_t{width} * height && "a pixel each");
    media::Image image(width, height);
    for (size_t i = 0; i < premultiplied.size(); ++i) {
        const glm::vec4& light = premultiplied[i];
        uint8_t* pixel = &image.rgba[4 * i];
        pixel[3] = byte_of(light.a);
        if (pixel[3] == 0) continue;
        for (int c = 0; c < 3; ++c) pixel[c] = srgb_byte(light[c] / light.a);
    }
    return image;
}

std::vector<std::vector<uint8_t>> mip_levels(const media::Image& image) {
    return levels_by(image, shrink_pixel);
}

std::vector<std::vector<uint8_t>> mip_levels_of_numbers(const media::Image& image) {
    return levels_by(image, shrink_numbers);
}

}  // namespace neuvv::render

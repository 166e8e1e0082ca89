#include "training/mattes/soft_edges.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/glm.hpp>
#include <optional>

namespace neuvv::training {

namespace {

constexpr uint32_t kColourRadius = 2;   // pixels from an edge pixel within which the performer's colour is sought
constexpr float kMinContrast = 1e-4f;   // squared, linear: below it, two colours count as equal
constexpr float kSureContrast = 4e-3f;  // the same for two colours of which neither is known exactly

glm::vec3 linear_colour(const media::Image& image, size_t pixel) {
    const uint8_t* rgb = &image.rgba[4 * pixel];
    return {media::linear_from_srgb_byte(rgb[0]), media::linear_from_srgb_byte(rgb[1]),
            media::linear_from_srgb_byte(rgb[2])};
}

// The mean colour of the mask's pixels at most `radius` beside or above a pixel; nothing where there are none.
std::optional<glm::vec3> colour_near(const media::Image& image, const PixelMask& mask, size_t pixel, uint32_t radius) {
    const auto x = static_cast<uint32_t>(pixel % mask.width), y = static_cast<uint32_t>(pixel / mask.width);
    glm::vec3 sum(0);
    float count = 0;
    for (uint32_t v = y - std::min(y, radius); v <= std::min(mask.height - 1, y + radius); ++v)
        for (uint32_t u = x - std::min(x, radius); u <= std::min(mask.width - 1, x + radius); ++u) {
            const size_t at = size_t{v} * mask.width + u;
            if (!mask[at]) continue;
            sum += linear_colour(image, at);
            ++count;
        }
    return count > 0 ? std::optional(sum / count) : std::nullopt;
}

// Where a colour lies between that behind and that in front; nothing where they differ by less than `contrast`.
std::optional<float> share_of(const glm::vec3& colour, const glm::vec3& behind, const glm::vec3& front,
                              float contrast) {
    const glm::vec3 towards = front - behind;
    const float distance = glm::dot(towards, towards);
    if (distance < contrast) return {};
    return std::clamp(glm::dot(colour - behind, towards) / distance, 0.0f, 1.0f);
}

uint8_t byte_of(float alpha) {
    return static_cast<uint8_t>(std::lround(255 * alpha));
}

}  // namespace

std::vector<uint8_t> soft_edges(const media::Image& image, const PixelMask& mask, const media::Image& background) {
    assert(image.rgba.size() == 4 * mask.size() && background.rgba.size() == 4 * mask.size() && "one size");
    const PixelMask inner = shrunk(mask, 1);
    std::vector<uint8_t> alpha(mask.size());
    for (size_t i = 0; i < alpha.size(); ++i) {
        if (!mask[i]) continue;
        alpha[i] = 255;
        if (inner[i]) continue;
        const std::optional<glm::vec3> front = colour_near(image, inner, i, kColourRadius);
        if (!front) continue;  // a part that is all border, such as a hair, is opaque
        const glm::vec3 behind = linear_colour(background, i);
        alpha[i] = byte_of(share_of(linear_colour(image, i), behind, *front, kMinContrast).value_or(1));
    }
    return alpha;
}

std::vector<uint8_t> soft_edges(const media::Image& image, const PixelMask& mask, uint32_t band) {
    assert(image.rgba.size() == 4 * mask.size() && "one size");
    const PixelMask inner = shrunk(mask, band), outer = inverse(grown(mask, band));
    const uint32_t radius = 2 * band + kColourRadius;
    std::vector<uint8_t> alpha(mask.size());
    for (size_t i = 0; i < alpha.size(); ++i) {
        if (mask[i]) alpha[i] = 255;
        if (inner[i] || outer[i]) continue;
        const std::optional<glm::vec3> front = colour_near(image, inner, i, radius);
        const std::optional<glm::vec3> behind = colour_near(image, outer, i, radius);
        if (!front || !behind) continue;
        const std::optional<float> share = share_of(linear_colour(image, i), *behind, *front, kSureContrast);
        if (share) alpha[i] = byte_of(*share);
    }
    return alpha;
}

}  // namespace neuvv::training

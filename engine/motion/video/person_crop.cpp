#include "motion/video/person_crop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace neuvv::motion {

namespace {

constexpr double kAround = 1.25;               // of the box: what top-down detectors are trained with
constexpr int kSameBorder = 4;                 // how much the border of one colour may vary, of 255
constexpr int kForeground = 16;                // and by how much the performer differs from it
constexpr uint8_t kOpaque = 128;               // alpha from which a pixel is the performer
constexpr uint8_t kGrey[3] = {124, 124, 124};  // as `neuvv skeleton views` has behind performers
constexpr int kMostSamples = 8;                // along each side of a pixel

int colour_distance(const uint8_t* a, const uint8_t* b) {
    int most = 0;
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a[c] - b[c]));
    return most;
}

bool is_opaque(const media::Image& image) {
    for (size_t i = 3; i < image.rgba.size(); i += 4)
        if (image.rgba[i] != 255) return false;
    return true;
}

// The colour of the image's border, where it has one.
std::optional<std::array<uint8_t, 3>> border_colour(const media::Image& image) {
    const uint8_t* first = image.at(0, 0);
    const auto same = [&](uint32_t x, uint32_t y) { return colour_distance(image.at(x, y), first) <= kSameBorder; };
    for (uint32_t x = 0; x < image.width; ++x)
        if (!same(x, 0) || !same(x, image.height - 1)) return std::nullopt;
    for (uint32_t y = 0; y < image.height; ++y)
        if (!same(0, y) || !same(image.width - 1, y)) return std::nullopt;
    return std::array{first[0], first[1], first[2]};
}

template <typename IsPerson>
std::optional<PixelBox> box_where(const media::Image& image, IsPerson&& is_person) {
    PixelBox box{glm::dvec2(INFINITY), glm::dvec2(-INFINITY)};
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) {
            if (!is_person(image.at(x, y))) continue;
            box.low = glm::min(box.low, glm::dvec2(x, y));
            box.high = glm::max(box.high, glm::dvec2(x + 1, y + 1));
        }
    if (box.low.x > box.high.x) return std::nullopt;
    return box;
}

// Samples an image before a background of one colour.
class Sampler {
  public:
    Sampler(const media::Image& image, std::array<uint8_t, 3> background)
        : image_(media::composite_over(image, background.data())), background_(background) {}

    // Bilinear between pixel centres.
    glm::dvec3 at(const glm::dvec2& point) const {
        const glm::dvec2 p = point - 0.5, low = glm::floor(p), part = p - low;
        const auto x = static_cast<int64_t>(low.x), y = static_cast<int64_t>(low.y);
        return glm::mix(glm::mix(pixel(x, y), pixel(x + 1, y), part.x),
                        glm::mix(pixel(x, y + 1), pixel(x + 1, y + 1), part.x), part.y);
    }

  private:
    glm::dvec3 pixel(int64_t x, int64_t y) const {
        const bool inside = x >= 0 && y >= 0 && x < image_.width && y < image_.height;
        const uint8_t* rgb =
            inside ? image_.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)) : background_.data();
        return {rgb[0], rgb[1], rgb[2]};
    }

    media::Image image_;
    std::array<uint8_t, 3> background_;
};

}  // namespace

std::optional<PixelBox> person_box(const media::Image& image) {
    if (image.width == 0 || image.height == 0) return std::nullopt;
    if (!is_opaque(image)) return box_where(image, [](const uint8_t* pixel) { return pixel[3] >= kOpaque; });
    if (const auto border = border_colour(image))
        return box_where(image,
                         [&](const uint8_t* pixel) { return colour_distance(pixel, border->data()) > kForeground; });
    return PixelBox{{0, 0}, {image.width, image.height}};
}

PersonCrop crop_person(const media::Image& image, const PixelBox& box, uint32_t width, uint32_t height) {
    std::array<uint8_t, 3> background = {kGrey[0], kGrey[1], kGrey[2]};
    if (const auto border = border_colour(image); border && is_opaque(image)) background = *border;
    const Sampler sampler(image, background);
    PersonCrop crop{width, height, std::vector<float>(size_t{3} * width * height), {}, 1};
    const glm::dvec2 size = kAround * (box.high - box.low);
    crop.scale = std::max(size.x / width, size.y / height);
    crop.corner = 0.5 * (box.low + box.high - crop.scale * glm::dvec2(width, height));
    // Where many pixels of the image fall into one of the crop, their mean is taken.
    const int samples = std::clamp(static_cast<int>(std::ceil(crop.scale)), 1, kMostSamples);
    const size_t plane = size_t{width} * height;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            glm::dvec3 sum(0);
            for (int i = 0; i < samples * samples; ++i) {
                const glm::dvec2 inside(i % samples + 0.5, i / samples + 0.5);
                sum += sampler.at(crop.image_pixel(glm::dvec2(x, y) + inside / double(samples)));
            }
            sum /= samples * samples;
            for (int c = 0; c < 3; ++c)
                crop.rgb[static_cast<size_t>(c) * plane + size_t{y} * width + x] = static_cast<float>(sum[c]);
        }
    return crop;
}

}  // namespace neuvv::motion

#include "training/data/undistort.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace neuvv::training {

namespace {

constexpr glm::vec2 kUnseen(-1);

// The (up to four) pixels of the distorted image around a position, with their bilinear weights. A position in the
// outer half of a pixel at the border shows that pixel.
struct Taps {
    size_t pixel[4];
    float weight[4];
};

Taps taps_at(const Undistortion& map, glm::vec2 position) {
    const glm::vec2 last(static_cast<float>(map.width - 1), static_cast<float>(map.height - 1));
    const glm::vec2 at = glm::clamp(position - 0.5f, glm::vec2(0), last), low = glm::floor(at), part = at - low;
    const glm::vec2 high = glm::min(low + 1.0f, last);
    const size_t x[2] = {static_cast<size_t>(low.x), static_cast<size_t>(high.x)};
    const size_t y[2] = {static_cast<size_t>(low.y), static_cast<size_t>(high.y)};
    Taps taps;
    for (size_t i = 0; i < 4; ++i) {
        taps.pixel[i] = y[i / 2] * map.width + x[i % 2];
        taps.weight[i] = (i % 2 ? part.x : 1 - part.x) * (i / 2 ? part.y : 1 - part.y);
    }
    return taps;
}

}  // namespace

Undistortion make_undistortion(const interchange::Lens& lens) {
    assert(lens.width > 0 && lens.height > 0 && "a lens that knows its image's size");
    Undistortion map;
    map.width = lens.width;
    map.height = lens.height;
    map.positions.resize(size_t{lens.width} * lens.height, kUnseen);
    const auto direction = [&](double x, double y) {
        return glm::dvec2((x - lens.cx) / lens.fx, (y - lens.cy) / lens.fy);
    };
    double corner = 0;
    for (const double x : {0.0, double{1.0 * lens.width}})
        for (const double y : {0.0, double{1.0 * lens.height}}) corner = std::max(corner, glm::length(direction(x, y)));
    const double fold = interchange::fold_radius(lens, corner);
    if (fold < corner) map.fold_degrees = std::atan(fold) * 180 / std::numbers::pi;
    size_t seen = 0;
    for (uint32_t y = 0; y < lens.height; ++y)
        for (uint32_t x = 0; x < lens.width; ++x) {
            const glm::dvec2 xy = direction(x + 0.5, y + 0.5);
            if (glm::length(xy) > fold) continue;
            const glm::dvec2 position = project(lens, xy);
            if (!(position.x >= 0 && position.y >= 0 && position.x <= lens.width && position.y <= lens.height))
                continue;
            map.positions[size_t{y} * lens.width + x] = position;
            ++seen;
        }
    map.seen_share = static_cast<double>(seen) / static_cast<double>(map.positions.size());
    return map;
}

media::Image undistort(const media::Image& image, const Undistortion& map, ColourOf colour) {
    assert(image.width == map.width && image.height == map.height);
    media::Image result(map.width, map.height);
    for (size_t i = 0; i < map.positions.size(); ++i) {
        if (!map.sees(i)) continue;
        const Taps taps = taps_at(map, map.positions[i]);
        glm::vec3 light(0);
        float alpha = 0, weight = 0;
        for (size_t k = 0; k < 4; ++k) {
            const uint8_t* from = &image.rgba[4 * taps.pixel[k]];
            const float opacity = static_cast<float>(from[3]) / 255;
            const float share = taps.weight[k] * (colour == ColourOf::kForeground ? opacity : 1);
            light += share * glm::vec3(media::linear_from_srgb_byte(from[0]), media::linear_from_srgb_byte(from[1]),
                                       media::linear_from_srgb_byte(from[2]));
            weight += share;
            alpha += taps.weight[k] * opacity;
        }
        uint8_t* to = &result.rgba[4 * i];
        for (int c = 0; c < 3 && weight > 0; ++c) to[c] = media::srgb_byte_from_linear(light[c] / weight);
        to[3] = static_cast<uint8_t>(std::lround(alpha * 255));
    }
    return result;
}

std::vector<bool> undistort_ignored(const std::vector<bool>& ignored, const Undistortion& map) {
    std::vector<bool> result(map.positions.size());
    bool any = false;
    for (size_t i = 0; i < map.positions.size(); ++i) {
        bool unknown = !map.sees(i);
        if (!unknown && !ignored.empty()) {
            const Taps taps = taps_at(map, map.positions[i]);
            for (size_t k = 0; k < 4; ++k) unknown |= taps.weight[k] > 0 && ignored[taps.pixel[k]];
        }
        result[i] = unknown;
        any |= unknown;
    }
    if (!any) result.clear();
    return result;
}

}  // namespace neuvv::training

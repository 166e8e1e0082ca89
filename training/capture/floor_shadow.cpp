#include "training/capture/floor_shadow.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "motion/video/triangulate.h"
#include "training/capture/dome.h"

namespace neuvv::training {

namespace {

constexpr double kLightTaken = 0.5;  // of the lamp's light that the performer takes away
constexpr double kSoftness = 0.03;   // the blur's reach, as a share of the lamp's image
constexpr int kBlurs = 2;

// The mean of 2·reach + 1 values along a row or column; what is beyond the ends is 0.
void blur_line(float* first, size_t count, size_t stride, size_t reach, std::vector<float>& sums) {
    sums.assign(1, 0);
    for (size_t i = 0; i < count; ++i) sums.push_back(sums.back() + first[i * stride]);
    for (size_t i = 0; i < count; ++i)
        first[i * stride] =
            (sums[std::min(i + reach + 1, count)] - sums[i - std::min(i, reach)]) / static_cast<float>(2 * reach + 1);
}

}  // namespace

FloorShadow::FloorShadow(const stage::Camera& lamp, std::span<const glm::vec4> seen) : lamp_(lamp) {
    assert(seen.size() == size_t{lamp.width} * lamp.height && "an image of the lamp's size");
    for (const glm::vec4& light : seen) dark_.push_back(light.a);
    const auto reach = static_cast<size_t>(std::max(1.0, kSoftness * std::max(lamp.width, lamp.height)));
    std::vector<float> sums;
    for (int i = 0; i < kBlurs; ++i) {
        for (size_t y = 0; y < lamp.height; ++y) blur_line(&dark_[y * lamp.width], lamp.width, 1, reach, sums);
        for (size_t x = 0; x < lamp.width; ++x) blur_line(&dark_[x], lamp.height, lamp.width, reach, sums);
    }
}

double FloorShadow::light_at(const glm::dvec3& point) const {
    const std::optional<glm::dvec2> pixel = motion::project(lamp_, point);
    if (!pixel) return 1;
    const glm::dvec2 at = glm::floor(*pixel);
    if (at.x < 0 || at.y < 0 || at.x >= lamp_.width || at.y >= lamp_.height) return 1;
    const auto x = static_cast<size_t>(at.x), y = static_cast<size_t>(at.y);
    return 1 - kLightTaken * double{dark_[y * lamp_.width + x]};
}

stage::Camera lamp_above(const stage::Camera& camera, const glm::dvec3& centre, double distance) {
    constexpr double kNearlyAbove_deg = 89;  // of a camera that looks straight down, nobody knows which way is up
    const DomeCamera above = dome_camera(0, 0, glm::radians(kNearlyAbove_deg));
    stage::Camera lamp = camera;
    lamp.world_from_camera = glm::dmat4(above.world_from_camera);
    lamp.world_from_camera[3] = glm::dvec4(centre + distance * above.outward, 1);
    return lamp;
}

media::Image shaded(media::Image plate, const Backdrop& room, const stage::Camera& camera, const FloorShadow& shadow) {
    const glm::dvec3 eye(camera.world_from_camera[3]);
    for (uint32_t y = 0; y < plate.height; ++y)
        for (uint32_t x = 0; x < plate.width; ++x) {
            const Wall seen = wall_along(room, eye, direction_of(camera, x + 0.5, y + 0.5));
            if (!seen.is_floor) continue;
            const double light = shadow.light_at(seen.point);
            for (int c = 0; c < 3 && light < 1; ++c) {
                uint8_t& value = plate.at(x, y)[c];
                value = media::srgb_byte_from_linear(media::linear_from_srgb_byte(value) * static_cast<float>(light));
            }
        }
    return plate;
}

}  // namespace neuvv::training

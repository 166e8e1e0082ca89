#include "training/capture/backdrop.h"

#include <algorithm>
#include <cmath>

namespace neuvv::training {

namespace {

constexpr int kSamplesOfBackdrop = 3;  // along each side of a pixel

// Linear RGB. Each pair of opposite walls has its own two colours, so that a wrong background is easy to see.
constexpr glm::vec3 kColours[3][2] = {{{0.10f, 0.16f, 0.22f}, {0.42f, 0.50f, 0.55f}},
                                      {{0.16f, 0.15f, 0.14f}, {0.50f, 0.48f, 0.44f}},
                                      {{0.14f, 0.20f, 0.12f}, {0.48f, 0.54f, 0.42f}}};

glm::vec3 colour_at(const Backdrop& room, const Wall& wall) {
    const glm::dvec3 tile = glm::floor((wall.point - room.low) / room.tile_m);
    const double sum = tile[(wall.axis + 1) % 3] + tile[(wall.axis + 2) % 3];
    return kColours[wall.axis][std::fmod(std::abs(sum), 2.0) >= 1 ? 1 : 0];
}

}  // namespace

Wall wall_along(const Backdrop& room, const glm::dvec3& eye, const glm::dvec3& direction) {
    double nearest = INFINITY;
    Wall wall;
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0) continue;
        const double distance = ((direction[axis] > 0 ? room.high : room.low)[axis] - eye[axis]) / direction[axis];
        if (distance >= nearest) continue;
        nearest = distance;
        wall.axis = axis;
    }
    wall.is_floor = wall.axis == 1 && direction.y < 0;
    wall.point = eye + nearest * direction;
    return wall;
}

glm::dvec3 direction_of(const stage::Camera& camera, double x, double y) {
    return glm::dmat3(camera.world_from_camera) *
           glm::dvec3((x - camera.cx) / camera.fx, -(y - camera.cy) / camera.fy, -1);
}

media::Image clean_plate(const Backdrop& backdrop, const stage::Camera& camera) {
    media::Image plate(camera.width, camera.height);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            glm::vec3 sum(0);
            for (int s = 0; s < kSamplesOfBackdrop * kSamplesOfBackdrop; ++s) {
                const double px = x + (s % kSamplesOfBackdrop + 0.5) / kSamplesOfBackdrop,
                             py = y + (s / kSamplesOfBackdrop + 0.5) / kSamplesOfBackdrop;
                sum += colour_at(backdrop, wall_along(backdrop, eye, direction_of(camera, px, py)));
            }
            for (int c = 0; c < 3; ++c) {
                const auto linear = static_cast<double>(sum[c]) / (kSamplesOfBackdrop * kSamplesOfBackdrop);
                plate.at(x, y)[c] =
                    static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(std::clamp(linear, 0.0, 1.0))));
            }
            plate.at(x, y)[3] = 255;
        }
    return plate;
}

}  // namespace neuvv::training

#include "tools/viewer/tools/navigation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

namespace neuvv::viewer {

namespace {

using std::numbers::pi;
constexpr double kNotchFactor = 0.9;     // the share of the distance that a notch leaves
constexpr double kFramedShare = 0.9;     // the share of the image that a framed box fills
constexpr double kScrollHeights = 0.05;  // image heights per unit of a touchpad's scrolling
constexpr double kFlightScenesPerSecond = 0.5;
constexpr double kMaxCoordinate_m = 1e9;
constexpr double kPole = 1e-6;  // sine of the angle to the vertical within which yaw and roll are the same rotation

// The same angle between −π and π.
double wrapped(double angle) {
    return std::remainder(angle, 2 * pi);
}

double clamped_distance(double distance) {
    return std::clamp(distance, kMinEyeDistance_m, kMaxEyeDistance_m);
}

glm::dmat3 axes(const Eye& eye) {
    const glm::dmat4 yawed = glm::rotate(glm::dmat4(1), eye.yaw, glm::dvec3(0, 1, 0));
    const glm::dmat4 pitched = glm::rotate(yawed, eye.pitch, glm::dvec3(1, 0, 0));
    return glm::dmat3(glm::rotate(pitched, eye.roll, glm::dvec3(0, 0, 1)));
}

glm::dvec3 position_of(const Eye& eye) {
    return eye.pivot + axes(eye)[2] * eye.distance;
}

double metres_per_pixel(const Eye& eye, double height) {
    return 2 * eye.distance * std::tan(eye.angle_y / 2) / height;
}

bool is_within_world(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) <= kMaxCoordinate_m && v == v;
}

}  // namespace

glm::dmat4 world_from_eye(const Eye& eye) {
    glm::dmat4 matrix(axes(eye));
    matrix[3] = glm::dvec4(position_of(eye), 1);
    return matrix;
}

stage::Camera camera_of(const Eye& eye, uint32_t width, uint32_t height) {
    const double focal = height / (2 * std::tan(eye.angle_y / 2));
    return {world_from_eye(eye), focal, focal, width / 2.0, height / 2.0, width, height};
}

Eye orbited(const Eye& eye, glm::dvec2 moved_px, double height) {
    Eye moved = eye;
    moved.yaw = wrapped(eye.yaw - pi * moved_px.x / height);
    moved.pitch = std::clamp(eye.pitch - pi * moved_px.y / height, -pi / 2, pi / 2);
    return moved;
}

Eye turned(const Eye& eye, glm::dvec2 moved_px, double height) {
    Eye moved = orbited(eye, moved_px, height);
    moved.pivot = position_of(eye) - axes(moved)[2] * eye.distance;
    return moved;
}

Eye panned(const Eye& eye, glm::dvec2 moved_px, double height) {
    Eye moved = eye;
    const glm::dmat3 of = axes(eye);
    moved.pivot += (of[1] * moved_px.y - of[0] * moved_px.x) * metres_per_pixel(eye, height);
    return moved;
}

Eye dollied(const Eye& eye, double notches, const std::optional<glm::dvec3>& towards) {
    Eye moved = eye;
    moved.distance = clamped_distance(eye.distance * std::pow(kNotchFactor, notches));
    const glm::dvec3 about = towards.value_or(eye.pivot);
    moved.pivot = about + (eye.pivot - about) * (moved.distance / eye.distance);
    return moved;
}

bool is_wheel(const Scroll& scroll) {
    return scroll.offset.x == 0 && scroll.offset.y == std::round(scroll.offset.y);
}

Eye scrolled(const Eye& eye, const Scroll& scroll, double height, const std::optional<glm::dvec3>& towards) {
    if (is_wheel(scroll) || scroll.control) return dollied(eye, scroll.offset.y, towards);
    const glm::dvec2 moved_px = scroll.offset * (kScrollHeights * height);
    return scroll.shift ? panned(eye, moved_px, height) : orbited(eye, moved_px, height);
}

Eye flown(const Eye& eye, const FlightKeys& keys, double dt_s, double scene_m) {
    const glm::dmat3 of = axes(eye);
    glm::dvec3 direction = of[0] * keys.right + glm::dvec3(0, 1, 0) * keys.up - of[2] * keys.forward;
    direction /= std::max(1.0, glm::length(direction));
    const double speed = kFlightScenesPerSecond * scene_m * (keys.fast ? 4 : 1) / (keys.slow ? 4 : 1);
    Eye moved = eye;
    moved.pivot += direction * (speed * std::clamp(dt_s, 0.0, kMaxFlightStep_s));
    return moved;
}

Eye framed(const Eye& eye, glm::dvec3 low, glm::dvec3 high, double aspect) {
    if (!is_within_world(low) || !is_within_world(high)) return eye;
    Eye moved = eye;
    moved.pivot = (low + high) / 2.0;
    const glm::dmat3 from_camera = axes(eye);
    const double tan_y = kFramedShare * std::tan(eye.angle_y / 2), tan_x = tan_y * aspect;
    double distance = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
        const glm::dvec3 p = (corner - moved.pivot) * from_camera;  // in the camera's axes, about the middle
        distance = std::max({distance, p.z + std::abs(p.x) / tan_x, p.z + std::abs(p.y) / tan_y});
    }
    moved.distance = clamped_distance(distance > 0 ? distance : 1);
    return moved;
}

Eye seen_from(const Eye& eye, EyeSide side) {
    Eye moved = eye;
    moved.yaw = moved.pitch = moved.roll = 0;
    switch (side) {
        case EyeSide::kFront:
            break;
        case EyeSide::kBack:
            moved.yaw = pi;
            break;
        case EyeSide::kRight:
            moved.yaw = pi / 2;
            break;
        case EyeSide::kLeft:
            moved.yaw = -pi / 2;
            break;
        case EyeSide::kTop:
            moved.pitch = -pi / 2;
            break;
        case EyeSide::kBottom:
            moved.pitch = pi / 2;
            break;
    }
    return moved;
}

Eye looking_through(const glm::dmat4& world_from_camera, double angle_y, double distance_m) {
    const glm::dvec3 back = glm::normalize(glm::dvec3(world_from_camera[2]));
    const glm::dvec3 right = glm::normalize(glm::dvec3(world_from_camera[0]));
    assert(back == back && right == right);
    Eye eye;
    eye.angle_y = std::clamp(angle_y, kMinEyeAngle, kMaxEyeAngle);
    eye.distance = clamped_distance(distance_m);
    const double level = std::hypot(back.x, back.z);
    eye.pitch = std::atan2(-back.y, level);
    if (level > kPole) {
        eye.yaw = std::atan2(back.x, back.z);
        const glm::dvec3 unrolled = right * axes(eye);
        eye.roll = std::atan2(unrolled.y, unrolled.x);
    } else {
        eye.yaw = std::atan2(-right.z, right.x);
    }
    eye.pivot = glm::dvec3(world_from_camera[3]) - back * eye.distance;
    return eye;
}

double distance_to(const glm::dmat4& world_from_camera, glm::dvec3 low, glm::dvec3 high) {
    const glm::dvec3 to_centre = (low + high) / 2.0 - glm::dvec3(world_from_camera[3]);
    const double depth = -glm::dot(to_centre, glm::normalize(glm::dvec3(world_from_camera[2])));
    return clamped_distance(depth > kMinEyeDistance_m ? depth : glm::length(high - low) / 2);
}

Eye between(const Eye& from, const Eye& to, double elapsed_s) {
    if (elapsed_s >= kEyeMove_s) return to;
    const double x = std::max(elapsed_s, 0.0) / kEyeMove_s, part = x * x * (3 - 2 * x);
    Eye eye;
    eye.pivot = glm::mix(from.pivot, to.pivot, part);
    eye.yaw = from.yaw + part * wrapped(to.yaw - from.yaw);
    eye.pitch = from.pitch + part * (to.pitch - from.pitch);
    eye.roll = from.roll + part * wrapped(to.roll - from.roll);
    eye.distance = from.distance * std::pow(to.distance / from.distance, part);
    eye.angle_y = from.angle_y + part * (to.angle_y - from.angle_y);
    return eye;
}

}  // namespace neuvv::viewer

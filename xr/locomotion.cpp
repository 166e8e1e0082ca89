#include "xr/locomotion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::xr {

namespace {

constexpr double kGravity_m_per_s2 = 9.81;

double wrapped(double angle_rad) {
    return std::remainder(angle_rad, 2 * std::numbers::pi);
}

bool is_finite(glm::dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The rig, moved so that the head comes to this position in the world.
XrRig with_head_at(XrRig rig, const Pose& head_in_tracking, glm::dvec3 head_world) {
    rig.position = head_world - turn_by(rig.yaw_rad) * head_in_tracking.position;
    return rig;
}

// The path of a point that is thrown without drag.
class Throw {
  public:
    Throw(glm::dvec3 origin, glm::dvec3 velocity)
        : origin_(origin), velocity_(velocity), across_(std::hypot(velocity.x, velocity.z)) {}

    glm::dvec3 at(double t_s) const {
        return origin_ + velocity_ * t_s - glm::dvec3(0, 0.5 * kGravity_m_per_s2 * t_s * t_s, 0);
    }
    double speed(double t_s) const { return std::hypot(across_, velocity_.y - kGravity_m_per_s2 * t_s); }

    // The length of the path from the start, in metres: the integral of √(across² + u²) / g over the upward speed u.
    double length(double t_s) const {
        return (integral(velocity_.y) - integral(velocity_.y - kGravity_m_per_s2 * t_s)) / kGravity_m_per_s2;
    }

    // The time, in seconds, at which the point passes this height on its way down, which may be at once; empty where it
    // never does.
    std::optional<double> falls_to(double y) const {
        const double square = velocity_.y * velocity_.y + 2 * kGravity_m_per_s2 * (origin_.y - y);
        const double t_s = (velocity_.y + std::sqrt(square)) / kGravity_m_per_s2;
        if (!(square >= 0 && t_s >= 0)) return {};
        return t_s;
    }

    // The time, between two others, at which the path has this length: by Newton's method, with bisection where a step
    // leaves the interval.
    double time_at_length(double length_m, double low_s, double high_s) const {
        constexpr double kWithin_m = 1e-6;
        double t_s = 0.5 * (low_s + high_s);
        for (int i = 0; i < 60; ++i) {
            const double over = length(t_s) - length_m;
            if (std::abs(over) < kWithin_m) break;
            (over > 0 ? high_s : low_s) = t_s;
            t_s -= over / speed(t_s);
            if (!(t_s > low_s && t_s < high_s)) t_s = 0.5 * (low_s + high_s);
        }
        return t_s;
    }

  private:
    double integral(double u) const {
        constexpr double kUpright_m_per_s = 1e-9;
        const double bent = across_ > kUpright_m_per_s ? across_ * across_ * std::asinh(u / across_) : 0;
        return 0.5 * (u * std::hypot(across_, u) + bent);
    }
    glm::dvec3 origin_, velocity_;
    double across_;
};

}  // namespace

Pose world_from_tracking(const XrRig& rig) {
    return {rig.position, turn_by(rig.yaw_rad)};
}

XrRig turned_about_head(XrRig rig, const Pose& head_in_tracking, double by_rad) {
    if (!is_valid(head_in_tracking) || !std::isfinite(by_rad)) return rig;
    const glm::dvec3 head_world = world_from_tracking(rig) * head_in_tracking.position;
    rig.yaw_rad = wrapped(rig.yaw_rad + by_rad);
    return with_head_at(rig, head_in_tracking, head_world);
}

XrRig with_head_above(XrRig rig, const Pose& head_in_tracking, glm::dvec3 floor_point_world,
                      std::optional<double> face_yaw_rad) {
    if (!is_valid(head_in_tracking) || !is_finite(floor_point_world)) return rig;
    if (face_yaw_rad && !std::isfinite(*face_yaw_rad)) return rig;
    if (face_yaw_rad) rig.yaw_rad = wrapped(*face_yaw_rad - yaw_of(head_in_tracking.rotation));
    return with_head_at(rig, head_in_tracking, floor_point_world + glm::dvec3(0, head_in_tracking.position.y, 0));
}

XrRig in_new_space(const XrRig& rig, const Pose& old_from_new) {
    if (!is_valid(old_from_new)) return rig;
    const glm::dvec3 across(old_from_new.position.x, 0, old_from_new.position.z);
    return {world_from_tracking(rig) * across, wrapped(rig.yaw_rad + yaw_of(old_from_new.rotation))};
}

Arc teleport_arc(const Pose& world_aim, double floor_y, double speed_m_per_s, double max_distance_m) {
    constexpr double kMax = 1e6;  // of speeds and distances; larger ones are mistakes
    if (!is_valid(world_aim) || !std::isfinite(floor_y)) return {};
    if (!(speed_m_per_s >= 0 && speed_m_per_s <= kMax && max_distance_m > 0 && max_distance_m <= kMax)) return {};
    const Throw thrown(world_aim.position, forward_of(world_aim) * speed_m_per_s);

    Arc arc;
    const std::optional<double> fallen_s = thrown.falls_to(floor_y);
    const bool lands = fallen_s && thrown.length(*fallen_s) <= max_distance_m;
    double end_s = lands ? *fallen_s : 1;
    if (!lands) {
        while (thrown.length(end_s) < max_distance_m) end_s *= 2;
        end_s = thrown.time_at_length(max_distance_m, 0, end_s);
    }

    const double length_m = thrown.length(end_s);
    const double pieces = std::min(std::ceil(length_m / kArcSpacing_m), static_cast<double>(kMaxArcPoints - 1));
    double t_s = 0;
    arc.points.push_back(world_aim.position);
    for (int i = 1; i < static_cast<int>(pieces); ++i) {
        t_s = thrown.time_at_length(length_m * i / pieces, t_s, end_s);
        arc.points.push_back(thrown.at(t_s));
    }
    if (pieces > 0) arc.points.push_back(thrown.at(end_s));
    if (lands) {
        arc.points.back().y = floor_y;
        arc.landing = arc.points.back();
    }
    return arc;
}

XrRig walked(XrRig rig, const Pose& head_in_tracking, glm::dvec2 stick, double metres_per_s, double dt_s,
             double dead_zone) {
    const double out = glm::length(stick);
    if (!is_valid(head_in_tracking) || !std::isfinite(out) || !std::isfinite(metres_per_s)) return rig;
    if (!(dt_s > 0) || !(out > dead_zone) || !(dead_zone >= 0 && dead_zone < 1)) return rig;
    const double share = std::min((out - dead_zone) / (1 - dead_zone), 1.0);
    const double length_m = share * metres_per_s * std::min(dt_s, kMaxStep_s);
    const glm::dquat heading = turn_by(rig.yaw_rad + yaw_of(head_in_tracking.rotation));
    rig.position += heading * (glm::dvec3(stick.x, 0, -stick.y) / out * length_m);
    return rig;
}

double vignette_of(double speed_m_per_s, double turn_rad_per_s) {
    const auto counted = [](double rate) { return std::isnan(rate) ? 0 : rate; };
    const double x = std::min(
        std::hypot(counted(speed_m_per_s) / kVignetteSpeed_m_per_s, counted(turn_rad_per_s) / kVignetteTurn_rad_per_s),
        1.0);
    return x * x * (3 - 2 * x);
}

}  // namespace neuvv::xr

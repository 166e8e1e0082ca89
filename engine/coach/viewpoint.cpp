#include "coach/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::coach {

namespace {

constexpr int kAround = 24;                             // candidates at each height
constexpr double kHeights_deg[] = {-5, 15, 35, 55};     // above the horizon
constexpr double kLowest_deg = -20, kHighest_deg = 60;  // where a person may look from
constexpr double kClothes = 0.3;  // of a bone's radius: how far clothes stand off, which hide, too
constexpr double kGain = 1.25, kPatience_s = 0.5;
constexpr double kLevel = 0.15;  // of what is seen, that an eye straight above or below loses against a level one

// The least distance between the segment from `eye` to `end` and a bone's surface, metres; negative where the segment
// enters the bone. It is that of two segments (Ericson, Real-Time Collision Detection, 5.1.9), less the bone's radius.
double segment_distance(const glm::dvec3& eye, const glm::dvec3& end, const render::Bone& bone) {
    const glm::dvec3 from(bone.from), d1 = end - eye, d2 = glm::dvec3(bone.to) - from, r = eye - from;
    const double a = glm::dot(d1, d1), e = std::max(glm::dot(d2, d2), 1e-12), f = glm::dot(d2, r);
    const double c = glm::dot(d1, r), b = glm::dot(d1, d2), across = a * e - b * b;
    double s = across > 1e-12 ? std::clamp((b * f - c * e) / across, 0.0, 1.0) : 0;
    const double t = std::clamp((b * s + f) / e, 0.0, 1.0);
    s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0;
    return glm::distance(eye + s * d1, from + t * d2) - static_cast<double>(bone.radius);
}

double distance_to(const glm::dvec3& point, const render::Bone& bone) {
    return segment_distance(point, point, bone);
}

double clothes_of(const BodyBone& each) {
    return kClothes * static_cast<double>(each.bone.radius);
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace

bool is_hidden(const glm::dvec3& point, std::span<const BodyBone> body, const glm::dvec3& eye) {
    double own = 0;  // the thickness of what the point is in
    for (const BodyBone& each : body)
        if (distance_to(point, each.bone) < clothes_of(each))
            own = std::max(own, 2 * static_cast<double>(each.bone.radius));
    const double distance = glm::distance(eye, point);
    if (distance <= own) return false;
    const glm::dvec3 before = point + own / distance * (eye - point);
    return std::ranges::any_of(
        body, [&](const BodyBone& each) { return segment_distance(eye, before, each.bone) < clothes_of(each); });
}

double seen_error(std::span<const JointError> errors, std::span<const BodyBone> body, const glm::dvec3& eye) {
    double sum = 0, weights = 0;
    for (const JointError& error : errors) {
        weights += error.weight;
        if (is_hidden(error.to, body, eye)) continue;
        const double angle = angle_between(error.from - eye, error.to - eye);
        sum += error.weight * angle * angle;
    }
    return weights > 0 ? std::sqrt(sum / weights) : 0;
}

std::vector<glm::dvec3> candidate_eyes(std::span<const JointError> errors, const glm::dvec3& centre, double distance) {
    std::vector<glm::dvec3> eyes;
    for (const double height_deg : kHeights_deg)
        for (int i = 0; i < kAround; ++i) {
            const double turn = 2 * std::numbers::pi * i / kAround, up = glm::radians(height_deg);
            eyes.push_back(centre + distance * glm::dvec3(std::cos(up) * std::sin(turn), std::sin(up),
                                                          std::cos(up) * std::cos(turn)));
        }
    std::vector<motion::WeightedError> weighted;
    for (const JointError& error : errors) weighted.push_back(error.weighted());
    for (const glm::dvec3& axis : {motion::best_view_direction(weighted), motion::best_level_view(weighted)})
        for (const double sign : {1.0, -1.0}) {
            const double height_deg = glm::degrees(std::asin(std::clamp(sign * axis.y, -1.0, 1.0)));
            if (height_deg >= kLowest_deg && height_deg <= kHighest_deg)
                eyes.push_back(centre + distance * sign * axis);
        }
    return eyes;
}

std::optional<glm::dvec3> ViewChooser::choose(std::span<const JointError> errors, std::span<const BodyBone> body,
                                              const glm::dvec3& centre, double distance, double step_s) {
    const auto eye = [&] { return direction_ ? std::optional(centre + distance * *direction_) : std::nullopt; };
    if (errors.empty()) {
        better_s_ = 0;
        return eye();
    }
    const std::vector<glm::dvec3> eyes = candidate_eyes(errors, centre, distance);
    std::vector<double> values;
    const auto value = [&](const glm::dvec3& at) {
        return seen_error(errors, body, at) * (1 - kLevel * std::abs(at.y - centre.y) / distance);
    };
    for (const glm::dvec3& each : eyes) values.push_back(value(each));
    const auto best = std::ranges::max_element(values);
    const bool better = !direction_ || *best > kGain * value(*eye());
    better_s_ = better ? better_s_ + step_s : 0;
    if (better && (!direction_ || better_s_ >= kPatience_s)) {
        direction_ = glm::normalize(eyes[static_cast<size_t>(best - values.begin())] - centre);
        better_s_ = 0;
    }
    return eye();
}

}  // namespace neuvv::coach

#include "tools/headset/state/panel_placement.h"

#include <algorithm>
#include <glm/gtc/constants.hpp>

namespace neuvv::headset {

namespace {

constexpr int kAround = 16;  // points of an ellipse
constexpr double kGap_rad = glm::radians(1.0);
constexpr double kInView_rad = glm::radians(40.0);     // from the centre of the view to its edge
constexpr double kFreeAside_rad = glm::radians(10.0);  // of a panel that is about nobody

// The head, without its tilt to the side.
xr::Pose upright(const xr::Pose& head) {
    const double pitch_rad = std::asin(glm::clamp(xr::forward_of(head).y, -1.0, 1.0));
    return {head.position, xr::turn_by(xr::yaw_of(head.rotation)) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0))};
}

// The panel in a direction, so many radians to the left of where the head looks.
PanelPlacement placed(const xr::Pose& head, double left_rad, double width_rad) {
    const glm::dvec3 direction = head.rotation * glm::dvec3(-std::sin(left_rad), 0, -std::cos(left_rad));
    const double width_m = 2 * kPanelAway_m * std::tan(0.5 * width_rad);
    return {{head.position + kPanelAway_m * direction, upright_towards(direction)}, {width_m, width_m / kPanelAspect}};
}

// The panel on one side of a box whose edge on that side is so far from the centre of the view, towards that side.
struct Side {
    double width_rad, aside_rad, covered_rad;
    // The less, the better: above all the panel covers little; then it is wide; then it is near the view's centre.
    double cost() const { return 10 * covered_rad + (kPanelWidth_rad - width_rad) + 0.1 * std::abs(aside_rad); }
};
Side side_beside(double edge_rad, double most_rad) {
    const double width_rad = std::clamp(2 * (most_rad - edge_rad), kMinPanelWidth_rad, kPanelWidth_rad);
    const double beside_rad = edge_rad + 0.5 * width_rad;
    const double aside_rad = std::clamp(beside_rad, -most_rad, most_rad);
    return {width_rad, aside_rad, std::max(beside_rad - aside_rad, 0.0)};
}

}  // namespace

glm::dquat upright_towards(glm::dvec3 direction) {
    const double yaw_rad = std::atan2(-direction.x, -direction.z),
                 pitch_rad = std::asin(glm::clamp(direction.y, -1.0, 1.0));
    return xr::turn_by(yaw_rad) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0));
}

std::optional<std::pair<double, double>> seen_between(const xr::Pose& world_head, const PlacedBox& box) {
    const xr::Pose head_from_world = xr::inverse(upright(world_head));
    const glm::dvec3 centre = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
    glm::dvec2 low(1e9), high(-1e9);
    for (int i = 0; i < 2 * kAround; ++i) {
        const double around = glm::two_pi<double>() * i / kAround, up = i < kAround ? -1 : 1;
        const glm::dvec3 of_box = centre + half * glm::dvec3(std::cos(around), up, std::sin(around));
        const glm::dvec3 at = head_from_world * glm::dvec3(box.world_from_box * glm::dvec4(of_box, 1));
        if (at.z > -0.05) return std::nullopt;
        const glm::dvec2 angles(std::atan2(-at.x, -at.z), std::atan2(at.y, -at.z));
        low = glm::min(low, angles);
        high = glm::max(high, angles);
    }
    if (low.x > kInView_rad || low.y > kInView_rad || high.x < -kInView_rad || high.y < -kInView_rad)
        return std::nullopt;
    return std::pair{low.x, high.x};
}

PanelPlacement panel_in_view(const xr::Pose& world_head, const std::optional<PlacedBox>& about, bool left_handed,
                             double aside_rad) {
    const xr::Pose head = upright(world_head);
    const auto seen = about ? seen_between(world_head, *about) : std::nullopt;
    if (!seen) return placed(head, left_handed ? -kFreeAside_rad : kFreeAside_rad, kPanelWidth_rad);
    const Side left = side_beside(seen->second + kGap_rad, aside_rad),
               right = side_beside(-seen->first + kGap_rad, aside_rad);
    const double better_left = right.cost() - left.cost();
    const bool to_left = std::abs(better_left) > 1e-6 ? better_left > 0 : !left_handed;
    return to_left ? placed(head, left.aside_rad, left.width_rad) : placed(head, -right.aside_rad, right.width_rad);
}

}  // namespace neuvv::headset

#include "xr/grab.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::xr {

namespace {

double heading_of(glm::dvec3 direction) {
    return std::atan2(-direction.x, -direction.z);
}

// The least turn that carries one unit vector to another; half a turn stays as near to +Y as it can.
glm::dquat shortest_turn(glm::dvec3 from, glm::dvec3 to) {
    constexpr double kOpposite = 1e-9, kVertical = 1e-6;
    const double w = 1 + glm::dot(from, to);
    if (w > kOpposite) return glm::normalize(glm::dquat(w, glm::cross(from, to)));
    const glm::dvec3 axis = glm::dvec3(0, 1, 0) - from * from.y;
    const double length = glm::length(axis);
    return {0, length > kVertical ? axis / length : glm::dvec3(1, 0, 0)};
}

}  // namespace

Grab::Grab(const glm::dmat4& world_from_node, GrabSettings settings) : settings_(settings), anchor_(world_from_node) {
    assert(settings.least_scale > 0 && settings.least_scale <= 1 && settings.most_scale >= 1 &&
           "the scale at the start is within its limits");
}

size_t Grab::index(int hand) {
    assert((hand == 0 || hand == 1) && "a hand is 0 or 1");
    return hand == 0 ? 0 : 1;
}

void Grab::take(int hand, const Pose& world_from_hand, double distance_m) {
    if (!is_sound(world_from_hand) || !std::isfinite(distance_m) || distance_m < 0) return;
    const glm::dmat4 now = world_from_node();
    const double scale_now = scale();
    Hand& taking = hands_[index(hand)];
    taking.holds = true;
    taking.now = world_from_hand;
    taking.distance_m = distance_m;
    anchor_at(now, scale_now);
}

void Grab::let_go(int hand) {
    if (!holds(hand)) return;
    const glm::dmat4 now = world_from_node();
    const double scale_now = scale();
    hands_[index(hand)].holds = false;
    anchor_at(now, scale_now);
}

void Grab::move(int hand, const Pose& world_from_hand) {
    if (!holds(hand) || !is_sound(world_from_hand)) return;
    hands_[index(hand)].now = world_from_hand;
    follow();
}

void Grab::reach(int hand, double by_m) {
    if (!holds(hand) || both() || !std::isfinite(by_m)) return;
    double& distance = hands_[index(hand)].distance_m;
    distance = std::max(distance + by_m, std::min(distance, kNearest_m));
}

glm::dmat4 Grab::world_from_node() const {
    if (empty()) return anchor_;
    glm::dvec3 from(0), to(0);  // the middle of the held points, at the anchor and now
    for (const Hand& hand : hands_)
        if (hand.holds) {
            const double share = both() ? 0.5 : 1;
            from += hand.anchor_point * share;
            to += hand.point() * share;
        }
    const glm::dmat3 linear = glm::mat3_cast(turn_) * factor();
    glm::dmat4 moved = anchor_;
    for (int i = 0; i < 3; ++i) moved[i] = glm::dvec4(linear * glm::dvec3(anchor_[i]), anchor_[i].w);
    moved[3] = glm::dvec4(to + linear * (glm::dvec3(anchor_[3]) - from), anchor_[3].w);
    return moved;
}

// Since the anchor.
double Grab::factor() const {
    if (!both()) return 1;
    const auto counted = [](glm::dvec3 apart) { return std::max(glm::length(apart), kLeastApart_m); };
    const double wanted = anchor_scale_ * counted(apart()) / counted(anchor_apart());
    return std::clamp(wanted, settings_.least_scale, settings_.most_scale) / anchor_scale_;
}

// Whether the hands say how the thing is turned.
bool Grab::turns() const {
    if (both()) {
        const glm::dvec3 line = apart();
        const double length = glm::length(line);
        return length >= kLeastApart_m && (!settings_.upright || std::hypot(line.x, line.z) >= kLeastLean * length);
    }
    const Hand& hand = hands_[holds(0) ? 0 : 1];
    return !settings_.upright ||
           tilt_cosine_of(hand.now.rotation * glm::conjugate(hand.anchor.rotation)) >= kLeastUpright;
}

void Grab::anchor_at(const glm::dmat4& world_from_node, double scale) {
    anchor_ = world_from_node;
    anchor_scale_ = scale;
    turn_ = glm::dquat(1, 0, 0, 0);
    for (Hand& hand : hands_) {
        hand.anchor = hand.now;
        hand.anchor_point = hand.point();
    }
    turning_ = empty() || turns();
}

// Brings turn_ up to the hands' poses. It rests while they do not say how to turn; when they do again it goes on from
// there, from a new anchor.
void Grab::follow() {
    if (!turns()) {
        turning_ = false;
    } else if (!turning_) {
        anchor_at(world_from_node(), scale());
    } else if (both()) {
        follow_line();
    } else {
        const Hand& hand = hands_[holds(0) ? 0 : 1];
        const glm::dquat turn =
            glm::normalize(hand.now.rotation) * glm::conjugate(glm::normalize(hand.anchor.rotation));
        turn_ = settings_.upright ? turn_by(twist_of(turn)) : turn;
    }
}

// From the line as it has been carried so far, not from the anchor's: the shortest way from that flips about when the
// line has turned by half a turn, which hands reach in a few moves.
void Grab::follow_line() {
    const glm::dvec3 from = turn_ * glm::normalize(anchor_apart()), to = glm::normalize(apart());
    const glm::dquat step =
        settings_.upright ? turn_by(heading_of(to) - heading_of(from)) : shortest_turn(glm::normalize(from), to);
    turn_ = glm::normalize(step * turn_);
}

}  // namespace neuvv::xr

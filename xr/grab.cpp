#include "xr/grab.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::xr {

namespace {

double heading_of(glm::dvec3 direction) {
    return std::atan2(-direction.x, -direction.z);
}

// The smallest rotation from one unit vector to another. Between opposite vectors, the axis is the one nearest to +Y.
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
    assert(settings.min_scale > 0 && settings.min_scale <= 1 && settings.max_scale >= 1 &&
           "the scale at the start is within its limits");
}

size_t Grab::index(int hand) {
    assert((hand == 0 || hand == 1) && "a hand is 0 or 1");
    return hand == 0 ? 0 : 1;
}

void Grab::attach(int hand, const Pose& world_from_hand, double distance_m) {
    if (!is_valid(world_from_hand) || !std::isfinite(distance_m) || distance_m < 0) return;
    const glm::dmat4 now = world_from_node();
    const double scale_now = scale();
    Hand& attaching = hands_[index(hand)];
    attaching.attached = true;
    attaching.now = world_from_hand;
    attaching.distance_m = distance_m;
    reset_anchor(now, scale_now);
}

void Grab::detach(int hand) {
    if (!is_attached(hand)) return;
    const glm::dmat4 now = world_from_node();
    const double scale_now = scale();
    hands_[index(hand)].attached = false;
    reset_anchor(now, scale_now);
}

void Grab::move(int hand, const Pose& world_from_hand) {
    if (!is_attached(hand) || !is_valid(world_from_hand)) return;
    hands_[index(hand)].now = world_from_hand;
    update_turn();
}

void Grab::push(int hand, double by_m) {
    if (!is_attached(hand) || both_attached() || !std::isfinite(by_m)) return;
    double& distance = hands_[index(hand)].distance_m;
    distance = std::max(distance + by_m, std::min(distance, kMinDistance_m));
}

glm::dmat4 Grab::world_from_node() const {
    if (empty()) return anchor_;
    glm::dvec3 from(0), to(0);  // the centre of the attached hands' points, at the anchor and now
    for (const Hand& hand : hands_)
        if (hand.attached) {
            const double share = both_attached() ? 0.5 : 1;
            from += hand.anchor_point * share;
            to += hand.point() * share;
        }
    const glm::dmat3 linear = glm::mat3_cast(turn_) * factor();
    glm::dmat4 moved = anchor_;
    for (int i = 0; i < 3; ++i) moved[i] = glm::dvec4(linear * glm::dvec3(anchor_[i]), anchor_[i].w);
    moved[3] = glm::dvec4(to + linear * (glm::dvec3(anchor_[3]) - from), anchor_[3].w);
    return moved;
}

void Grab::advance(double dt_s) {
    constexpr double kSlowest_per_s = 5, kFaster_per_s_and_m = 8000;  // by how far the hands' distance is off
    constexpr double kMostOff_m = 0.003;  // what is further off in a frame ends nearer to where it should be
    if (!both_attached() || !(dt_s > 0)) return;
    const double now_m = glm::length(apart());
    double off_m = apart_m_ - now_m;
    if (std::abs(off_m) > kMostOff_m) off_m = kMostOff_m * kMostOff_m / off_m;
    apart_m_ = now_m + off_m * std::exp(-dt_s * (kSlowest_per_s + kFaster_per_s_and_m * std::abs(off_m)));
}

// The change of the object's scale since the anchor.
double Grab::factor() const {
    if (!both_attached()) return 1;
    const double from_m = std::max(glm::length(anchor_apart()), kMinApart_m);
    const double unclamped = anchor_scale_ * std::max(apart_m_, kMinApart_m) / from_m;
    return std::clamp(unclamped, settings_.min_scale, settings_.max_scale) / anchor_scale_;
}

// Whether the hands define how the object is turned: false where they are too near to each other, and, for an upright
// object, where the line between them is too vertical, or a single hand is tilted too far.
bool Grab::hands_define_turn() const {
    if (both_attached()) {
        const glm::dvec3 line = apart();
        const double length = glm::length(line);
        return length >= kMinApart_m && (!settings_.upright || std::hypot(line.x, line.z) >= kMinLean * length);
    }
    const Hand& hand = hands_[is_attached(0) ? 0 : 1];
    return !settings_.upright ||
           tilt_cosine_of(hand.now.rotation * glm::conjugate(hand.anchor.rotation)) >= kMinTiltCosine;
}

void Grab::reset_anchor(const glm::dmat4& world_from_node, double scale) {
    anchor_ = world_from_node;
    anchor_scale_ = scale;
    turn_ = glm::dquat(1, 0, 0, 0);
    for (Hand& hand : hands_) {
        hand.anchor = hand.now;
        hand.anchor_point = hand.point();
    }
    apart_m_ = glm::length(apart());
    turning_ = empty() || hands_define_turn();
}

// Updates turn_ to the hands' poses. While the hands do not define a turn, turn_ stays as it is; when they define one
// again, it goes on from a new anchor.
void Grab::update_turn() {
    if (!hands_define_turn()) {
        turning_ = false;
    } else if (!turning_) {
        // From where the hands lead, which the smoothed scale has not reached yet.
        const double scale_now = scale();
        apart_m_ = glm::length(apart());
        reset_anchor(world_from_node(), scale());
        apart_m_ *= scale_now / anchor_scale_;
    } else if (both_attached()) {
        update_turn_from_line();
    } else {
        const Hand& hand = hands_[is_attached(0) ? 0 : 1];
        const glm::dquat turn =
            glm::normalize(hand.now.rotation) * glm::conjugate(glm::normalize(hand.anchor.rotation));
        turn_ = settings_.upright ? turn_by(twist_of(turn)) : turn;
    }
}

// Each step turns from the anchor's line as turn_ has rotated it so far. The smallest rotation from the anchor's line
// itself would flip where the line has turned by half a turn, which hands reach in a few moves.
void Grab::update_turn_from_line() {
    const glm::dvec3 from = turn_ * glm::normalize(anchor_apart()), to = glm::normalize(apart());
    const glm::dquat step =
        settings_.upright ? turn_by(heading_of(to) - heading_of(from)) : shortest_turn(glm::normalize(from), to);
    turn_ = glm::normalize(step * turn_);
}

}  // namespace neuvv::xr

// What one or two hands hold: how it moves, turns and grows with them.
//
// Each hand holds a point, straight in front of it (−Z) at some distance: on its pointing ray, or in the hand itself.
//
// One hand: the point keeps its place in the hand's frame, so that a swung ray carries the thing along, and the thing
// turns with the hand; where it is to stay upright, by the part of the hand's turn about +Y alone (twist_of).
//
// Two hands: the middle of the two points is carried along; the thing grows by the ratio of their distances and turns
// as the line between them does: by the shortest way from frame to frame, or, upright, about +Y alone. Where free, and
// within the limits of scale, both points stay where the hands hold them. Points nearer to each other than
// kLeastApart_m count as that far apart for the scale and turn nothing; upright, a line within kLeastLean of the
// vertical turns nothing either. Turning goes on from there when they come out of it.
//
// The result is continuous in the hands' poses and never jumps where a hand takes hold or lets go. Poses that are not
// sound (is_sound) are ignored.
#pragma once

#include <array>

#include "xr/pose.h"

namespace neuvv::xr {

struct GrabSettings {
    bool upright = true;
    // Of the thing's scale relative to the matrix that the Grab began with: 0 < least ≤ 1 ≤ most.
    double least_scale = 0.05, most_scale = 50;
};

class Grab {
  public:
    static constexpr double kLeastApart_m = 0.02;
    static constexpr double kLeastLean = 0.2;      // sine of the angle to the vertical
    static constexpr double kNearest_m = 0.1;      // as near as reach() pulls
    static constexpr double kLeastUpright = 0.15;  // tilt_cosine_of a hand's turn that still turns an upright thing

    explicit Grab(const glm::dmat4& world_from_node, GrabSettings settings = {});

    // A hand, 0 or 1, takes hold of the point `distance_m` in front of it; anew, where it held one. With a distance
    // that is not finite or below 0, or a pose that is not sound, it takes nothing.
    void take(int hand, const Pose& world_from_hand, double distance_m = 0);
    void let_go(int hand);
    bool holds(int hand) const { return hands_[index(hand)].holds; }
    bool empty() const { return !holds(0) && !holds(1); }

    // The hand's newest pose; means nothing of a hand that holds nothing.
    void move(int hand, const Pose& world_from_hand);

    // Pushes what this hand alone holds away along its −Z, or pulls it nearer (below 0), to kNearest_m at the nearest;
    // what was taken nearer than that comes no nearer. Nothing while two hands hold it.
    void reach(int hand, double by_m);

    // In front of the hand, to the point that it holds: as long as a ray should be drawn.
    double distance_m(int hand) const { return hands_[index(hand)].distance_m; }

    // As the hands have moved it.
    glm::dmat4 world_from_node() const;

    // Of it, relative to the matrix that the Grab began with.
    double scale() const { return anchor_scale_ * factor(); }

  private:
    struct Hand {
        bool holds = false;
        Pose now;
        double distance_m = 0;
        Pose anchor;                 // when the node stood at anchor_
        glm::dvec3 anchor_point{0};  // world: of the held point, then
        glm::dvec3 point() const { return now * glm::dvec3(0, 0, -distance_m); }
    };
    static size_t index(int hand);
    bool both() const { return holds(0) && holds(1); }
    glm::dvec3 apart() const { return hands_[1].point() - hands_[0].point(); }
    glm::dvec3 anchor_apart() const { return hands_[1].anchor_point - hands_[0].anchor_point; }
    double factor() const;
    bool turns() const;
    void anchor_at(const glm::dmat4& world_from_node, double scale);
    void follow();
    void follow_line();

    GrabSettings settings_;
    std::array<Hand, 2> hands_;
    glm::dmat4 anchor_;            // of the node when hands last took hold, let go, or began to turn it
    double anchor_scale_ = 1;      // relative to the first
    glm::dquat turn_{1, 0, 0, 0};  // since then
    bool turning_ = true;          // whether the hands' turns counted at the last move
};

}  // namespace neuvv::xr

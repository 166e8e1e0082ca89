// How an object that one or two hands have grabbed moves, turns and scales with them.
//
// Each attached hand grabs one point. The point lies straight in front of the hand (along −Z) at some distance: on the
// hand's pointer ray, or in the hand itself where the distance is 0.
//
// One hand: the point keeps its position in the hand's frame, so a ray that swings carries the object along. The object
// turns as the hand does. An upright object turns only by the part of the hand's rotation about +Y (twist_of).
//
// Two hands: the centre of the two points carries the object. The object scales by the ratio of the distances between
// the hands, and turns as the line between the hands does: from frame to frame by the smallest rotation, or, where the
// object is upright, about +Y alone. (The points would not do: 4 m away, one degree of a wrist moves a point by 7 cm.)
// The scale follows the hands' distance smoothly (advance). Hands nearer to each other than kMinApart_m count as that
// far apart for the scale and do not turn the object. A line within kMinLean of the vertical does not turn an upright
// object either. When the hands leave these ranges, the object goes on turning from the rotation that it has then.
//
// The result is continuous in the hands' poses, and never jumps where a hand is attached or detached. Poses that are
// not valid (is_valid) are ignored.
#pragma once

#include <array>

#include "xr/pose.h"

namespace neuvv::xr {

struct GrabSettings {
    bool upright = true;  // the object does not tilt
    // Limits of the object's scale, relative to the matrix that the Grab began with: 0 < min ≤ 1 ≤ max.
    double min_scale = 0.05, max_scale = 50;
};

// Hands are numbered 0 and 1; another number fails an assertion.
class Grab {
  public:
    static constexpr double kMinApart_m = 0.02;
    static constexpr double kMinLean = 0.2;         // sine of the angle to the vertical
    static constexpr double kMinDistance_m = 0.1;   // push() pulls no point nearer
    static constexpr double kMinTiltCosine = 0.15;  // a hand that tilts further (tilt_cosine_of) turns nothing upright

    explicit Grab(const glm::dmat4& world_from_node, GrabSettings settings = {});

    // Attaches a hand at the point `distance_m` in front of it, in place of a point where it was attached before. Does
    // nothing where the distance is not finite or below 0, or the pose is not valid.
    void attach(int hand, const Pose& world_from_hand, double distance_m = 0);
    void detach(int hand);
    bool is_attached(int hand) const { return hands_[index(hand)].attached; }
    // Whether no hand is attached.
    bool empty() const { return !is_attached(0) && !is_attached(1); }

    // Takes the newest pose of a hand; ignored for a hand that is not attached.
    void move(int hand, const Pose& world_from_hand);

    // Lets the scale follow the hands' distance for so long: slowly where the distance only trembles, and at once but
    // for a few millimetres where it changes. To be called once a frame, after move().
    void advance(double dt_s);

    // Pushes the point away along the hand's −Z, or pulls it nearer where `by_m` is below 0, but no nearer than
    // kMinDistance_m; a point that was attached nearer than that stays where it is. Does nothing unless this is the
    // only attached hand.
    void push(int hand, double by_m);

    // The distance from the hand to its point: how long its ray should be drawn.
    double distance_m(int hand) const { return hands_[index(hand)].distance_m; }

    // The object's transform as the hands have moved it.
    glm::dmat4 world_from_node() const;

    // The object's scale, relative to the matrix that the Grab began with.
    double scale() const { return anchor_scale_ * factor(); }

  private:
    struct Hand {
        bool attached = false;
        Pose now;
        double distance_m = 0;
        Pose anchor;                 // the hand's pose when the node's transform was anchor_
        glm::dvec3 anchor_point{0};  // world: where point() was at that time
        glm::dvec3 point() const { return now * glm::dvec3(0, 0, -distance_m); }
    };
    static size_t index(int hand);
    bool both_attached() const { return is_attached(0) && is_attached(1); }
    glm::dvec3 apart() const { return hands_[1].now.position - hands_[0].now.position; }
    glm::dvec3 anchor_apart() const { return hands_[1].anchor.position - hands_[0].anchor.position; }
    double factor() const;
    bool hands_define_turn() const;
    void reset_anchor(const glm::dmat4& world_from_node, double scale);
    void update_turn();
    void update_turn_from_line();

    GrabSettings settings_;
    std::array<Hand, 2> hands_;
    glm::dmat4 anchor_;        // the node's transform when a hand was last attached or detached, or began to turn it
    double apart_m_ = 0;       // between the hands, smoothed
    double anchor_scale_ = 1;  // of anchor_, relative to the matrix that the Grab began with
    glm::dquat turn_{1, 0, 0, 0};  // since anchor_
    bool turning_ = true;          // whether the hands turned the object at the last move
};

}  // namespace neuvv::xr

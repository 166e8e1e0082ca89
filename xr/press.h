// Analogue triggers and sticks as presses and steps: once each, however the value trembles.
#pragma once

#include <cassert>
#include <cmath>
#include <glm/glm.hpp>

namespace neuvv::xr {

// A trigger or grip: held from `on` upward until its value has fallen to `off`.
class Press {
  public:
    explicit Press(double on = 0.7, double off = 0.4) : on_(on), off_(off) { assert(off <= on); }

    // Once a frame. NaN counts as 0.
    void update(double value) {
        const bool was = held_;
        held_ = was ? value > off_ : value >= on_;  // false for NaN
        went_down_ = held_ && !was;
        went_up_ = !held_ && was;
    }
    bool held() const { return held_; }
    // Of the last update.
    bool went_down() const { return went_down_; }
    bool went_up() const { return went_up_; }

    // Lets go without went_up, as when another takes the controller's input away; a finger that is still down presses
    // anew at the next update.
    void reset() { held_ = went_down_ = went_up_ = false; }

  private:
    double on_, off_;
    bool held_ = false, went_down_ = false, went_up_ = false;
};

// A stick as steps in four directions, +X right and +Y up: one where it passes kOut, the next only after it has been
// within kBack in both axes. The larger axis says the direction; of two alike it is the horizontal one.
class Flick {
  public:
    static constexpr double kOut = 0.7, kBack = 0.35;

    // Once a frame. What is NaN counts as 0.
    void update(glm::dvec2 stick) {
        for (int i = 0; i < 2; ++i)
            if (std::isnan(stick[i])) stick[i] = 0;
        const bool sideways = std::abs(stick.x) >= std::abs(stick.y);
        const double larger = sideways ? stick.x : stick.y;
        step_ = glm::ivec2(0);
        if (armed_ && std::abs(larger) >= kOut) {
            armed_ = false;
            step_[sideways ? 0 : 1] = larger > 0 ? 1 : -1;
        } else if (std::abs(larger) <= kBack) {
            armed_ = true;
        }
    }

    // Of the last update.
    bool went_left() const { return step_.x < 0; }
    bool went_right() const { return step_.x > 0; }
    bool went_up() const { return step_.y > 0; }
    bool went_down() const { return step_.y < 0; }

  private:
    bool armed_ = true;
    glm::ivec2 step_{0};
};

}  // namespace neuvv::xr

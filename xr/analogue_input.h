// Analogue triggers as buttons, and sticks as steps. Two thresholds keep a trembling value from triggering twice.
#pragma once

#include <cassert>
#include <cmath>
#include <glm/glm.hpp>

namespace neuvv::xr {

// A trigger or grip: down from the value `on` upward, until the value has fallen to `off`.
class AnalogueButton {
  public:
    explicit AnalogueButton(double on = 0.7, double off = 0.4) : on_(on), off_(off) { assert(off <= on); }

    // To be called once a frame. NaN counts as 0.
    void update(double value) {
        const bool was_down = down_;
        down_ = was_down ? value > off_ : value >= on_;  // false for NaN
        pressed_ = down_ && !was_down;
        released_ = !down_ && was_down;
    }
    bool is_down() const { return down_; }
    // Whether the last update pressed or released the button.
    bool pressed() const { return pressed_; }
    bool released() const { return released_; }

    // Makes the button not down without a release, as when something else takes the controller's input away. A trigger
    // that is still pulled presses the button again at the next update.
    void reset() { down_ = pressed_ = released_ = false; }

  private:
    double on_, off_;
    bool down_ = false, pressed_ = false, released_ = false;
};

// A stick as steps in four directions, +X right and +Y up. A step happens where the stick passes kOut; the next one
// needs the stick to be within kBack in both axes first. The larger axis defines the direction; where both are equal,
// the horizontal one does.
class Flick {
  public:
    static constexpr double kOut = 0.7, kBack = 0.35;

    // To be called once a frame. NaN counts as 0.
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

    // Whether the last update was a step in this direction.
    bool went_left() const { return step_.x < 0; }
    bool went_right() const { return step_.x > 0; }
    bool went_up() const { return step_.y > 0; }
    bool went_down() const { return step_.y < 0; }

  private:
    bool armed_ = true;
    glm::ivec2 step_{0};
};

}  // namespace neuvv::xr

// Controllers and hands by OpenXR's actions: made of bindings.h, sampled once a frame.
#pragma once

#include <array>
#include <map>

#include "xr/bindings.h"
#include "xr/hands.h"
#include "xr/session.h"

namespace neuvv::xr {

class Actions {
  public:
    // One a session: it attaches its actions, which can be done once. The session must outlive it.
    explicit Actions(const Session& session);

    // What hands do now, and where they will be at `time`. Nothing of it while another program has the hands.
    HandInputs sample(XrTime time);
    // The hand feels something, 0..1 strong.
    void pulse(int hand, double amplitude, double seconds);
    // Other controllers were taken up: which ones.
    void look_at_controllers();
    // "Meta Touch"; empty: none.
    std::string controller(int hand) const;

  private:
    void make_actions();
    void suggest_bindings() const;
    void make_spaces();
    XrAction action(HandAction which) const { return actions_.at(which); }
    double value(HandAction which, int hand) const;
    glm::dvec2 axes(HandAction which, int hand) const;
    bool button(HandAction which, int hand, bool* changed = nullptr) const;
    bool pressed(HandAction which, int hand) const;

    const Session& session_;
    XrOwnedActionSet set_;
    std::map<HandAction, XrAction> actions_;  // the set's own
    std::array<XrPath, kHands> paths_{};
    std::array<XrOwnedSpace, kHands> aim_, grip_;
    std::array<const ControllerProfile*, kHands> profiles_{};
};

}  // namespace neuvv::xr

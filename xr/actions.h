// Input of controllers and hands by OpenXR's actions: created from the tables of bindings.h and sampled once a frame.
#pragma once

#include <array>
#include <map>

#include "xr/bindings.h"
#include "xr/body_points.h"
#include "xr/hands.h"
#include "xr/session.h"

namespace neuvv::xr {

class Actions {
  public:
    // Creates the actions, suggests their bindings and attaches them to the session, which OpenXR allows once for each
    // session. The session must outlive this object. `with_gaze`: whether locate_gaze() will be called; the user's eyes
    // are not asked for otherwise. Throws XrFailure.
    Actions(const Session& session, bool with_gaze);

    // The present state of buttons and sticks, and the poses of the hands as predicted for `time`. All is at rest while
    // the session does not have the input focus. Call it once a frame: buttons count as pressed since the last call.
    HandInputs sample(XrTime time);
    // Where worn trackers are, in the tracking space, as of the last sample(); none while the session does not have the
    // input focus.
    TrackerPositions locate_trackers(XrTime time) const;
    // Where the eyes look, as kGazePose, in the tracking space, as of the last sample(); nothing where the runtime does
    // not know it or has lost the eyes, and while the session does not have the input focus.
    std::optional<Pose> locate_gaze(XrTime time) const;
    // Vibrates a controller; `amplitude` is clamped to 0..1. Where the runtime refuses, nothing happens.
    void vibrate(int hand, double amplitude, double seconds);
    // Finds out which controllers the user holds; to be called when SessionEvents::controllers_changed says so.
    void update_controllers();
    // The controller's name, such as "Meta Touch", or the path of its profile, where this program does not know it;
    // empty where there is none.
    std::string controller(int hand) const;
    // The name of the button that triggers an action of a hand, by the runtime and in the user's language, such as
    // "Trigger"; of several, the first. Empty where no button does. As of the last update_controllers().
    const std::string& button_name(HandAction action, int hand) const { return button_names_[hand].at(action); }

  private:
    void create_actions();
    void create_tracker_action();
    void create_gaze_action();
    void suggest_bindings() const;
    void suggest(const char* profile, const char* title, const std::vector<XrActionSuggestedBinding>& bindings) const;
    std::vector<XrActionSuggestedBinding> tracker_bindings() const;
    void create_spaces();
    std::string find_button_name(HandAction which, int hand) const;
    XrAction action(HandAction which) const { return actions_.at(which); }
    double value(HandAction which, int hand) const;
    glm::dvec2 axes(HandAction which, int hand) const;
    bool button(HandAction which, int hand, bool* changed = nullptr) const;
    bool pressed(HandAction which, int hand) const;

    const Session& session_;
    XrOwnedActionSet set_;
    std::map<HandAction, XrAction> actions_;  // destroyed together with set_
    std::array<XrPath, kHands> paths_{};
    std::array<XrOwnedSpace, kHands> aim_, grip_;
    XrAction tracker_ = XR_NULL_HANDLE;  // the pose of a worn tracker; none where the runtime knows no trackers
    std::array<XrPath, kTrackers> tracker_paths_{};
    std::array<XrOwnedSpace, kTrackers> trackers_;
    XrAction gaze_ = XR_NULL_HANDLE;  // none where the runtime knows no gaze
    XrOwnedSpace gaze_space_;
    std::array<const ControllerProfile*, kHands> profiles_{};
    std::array<std::string, kHands> profile_paths_;
    std::array<std::map<HandAction, std::string>, kHands> button_names_;
};

}  // namespace neuvv::xr

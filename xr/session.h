// A session with the headset: its states, the poses of head and eyes, and the frame loop.
//
//     poll ─► wait_frame ─► begin_frame ─► locate_eyes ─► draw ─► end_frame
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "xr/pose.h"
#include "xr/runtime.h"

namespace neuvv::xr {

Pose pose_of(const XrPosef& pose);
XrPosef xr_pose(const Pose& pose);

// The state of a session after the events of a poll.
enum class SessionStatus {
    kIdle,     // there are no frames to draw: poll again soon
    kRunning,  // frames are to be waited for, begun and ended
    kEnded,    // the user or the runtime has ended the session
    kLost,     // the session cannot be used any more; a new one may work
};

// From a time on, all poses in the tracking space are in a new tracking space, or the user has asked to look ahead
// (recentring), or both.
struct TrackingChange {
    XrTime from = 0;  // of displays
    // The new tracking space in the old one: the identity where it has not moved, empty where the runtime does not
    // know.
    std::optional<Pose> old_from_new;
    // Whether the user asked for it, so as to look ahead. Otherwise the room's area or floor was found anew.
    bool by_user = false;
    bool moves() const {
        return !old_from_new || old_from_new->position != glm::dvec3(0) ||
               old_from_new->rotation != glm::dquat(1, 0, 0, 0);
    }
};

// The other events of a poll.
struct SessionEvents {
    // All changes that were reported and have not taken effect yet. It may have those of earlier polls before a poll.
    std::optional<TrackingChange> tracking_change;
    std::optional<bool> is_worn;  // whether somebody wears the headset, where that has changed
    // Whether the session has the input, where that has changed: it has not while the system's menu is in front.
    std::optional<bool> has_focus;
    bool passthrough_lost = false;               // call Room::restart
    bool controllers_changed = false;            // the user holds other controllers: call Actions::update_controllers
    std::array<bool, kMaxViews> mask_changed{};  // the lens hides another part of this view
};

constexpr double kEyeHeight_m = 1.6;  // above the floor, where the runtime does not know the floor

struct FrameTime {
    XrTime display = 0;          // when the display shows the frame, in nanoseconds of the runtime's clock
    XrDuration period = 0;       // of the display, nanoseconds
    bool should_render = false;  // else nobody would see the images
};

struct EyeView {
    Pose pose;  // in tracking space
    XrFovf fov{};
};
struct EyeViews {
    std::vector<EyeView> views;  // Runtime::view_count()
    bool follows_gaze = false;   // whether the narrow views are where the eyes look
};
// Whether a field of view spans an image: each angle is within 89.4° of the axis, left is less than right, and down is
// less than up. False for NaN.
bool spans_image(const XrFovf& fov);

class Session {
  public:
    // Runtime and device must outlive the session. Throws XrFailure.
    Session(const Runtime& runtime, const gpu::Device& device);

    XrSession handle() const { return session_.get(); }
    const Runtime& runtime() const { return runtime_; }
    // The space in which all poses are located: OpenXR's STAGE, whose origin lies on the floor in the centre of the
    // area where the user may walk. Where the runtime has no STAGE, LOCAL_FLOOR, whose origin lies on the floor where
    // the user was when the space was last centred. Where it has neither, a space kEyeHeight_m below the origin of
    // LOCAL, which is at the height of the eyes.
    //
    // Recentring moves LOCAL and LOCAL_FLOOR, and on most runtimes not STAGE. STAGE is preferred nevertheless, as poses
    // in it stay what they are: some runtimes move LOCAL_FLOOR before they say so. A change of LOCAL_FLOOR or of LOCAL
    // is the user's wish to look ahead.
    XrSpace tracking_space() const { return tracking_.get(); }
    bool knows_floor() const { return knows_floor_; }
    const char* floor_title() const;                // for people: how the floor is known
    bool offers(XrReferenceSpaceType space) const;  // whether the runtime has a space of this type
    // Whether the session has the user's input, as of the last poll(); not while the system's menu is open.
    bool has_focus() const { return state_ == XR_SESSION_STATE_FOCUSED; }
    XrSpace head_space() const { return head_.get(); }

    // Handles all waiting events; begins and ends the session as they demand. `events` receives what else they
    // reported. Throws XrFailure, with XR_ERROR_INSTANCE_LOST where the runtime is about to go away.
    SessionStatus poll(SessionEvents& events);
    // Asks the runtime to end the session; a later poll returns kEnded.
    void request_exit();

    // Waits until the runtime wants the next frame, which throttles the loop to the display. Throws XrFailure, also
    // where the session is lost.
    FrameTime wait_frame();
    void begin_frame();
    // Submits the layers of the frame; a later layer covers the earlier ones. Without layers the frame shows nothing.
    // `blend` must be one of Runtime::blend_modes().
    void end_frame(const FrameTime& time, XrEnvironmentBlendMode blend,
                   std::span<const XrCompositionLayerBaseHeader* const> layers);

    // The predicted poses (tracking space) and fields of view of the views; the narrow ones are where the eyes look,
    // where the runtime can do that and the eyes are tracked. While the head is not tracked, or where a
    // field of view spans no image, the last good ones; empty where there are none yet.
    std::optional<EyeViews> locate_eyes(XrTime time);
    // The pose of a space in the tracking space; empty while it is not tracked.
    std::optional<Pose> locate(XrSpace space, XrTime time) const;

    // The sides of the rectangle in which the user may walk, metres; nothing where the runtime does not know it.
    std::optional<glm::dvec2> play_area() const;

    // The display's refresh rates in Hz; empty where the runtime does not let a program choose one.
    std::vector<float> refresh_rates() const;
    void request_refresh_rate(float hz);

  private:
    void create_spaces();
    bool is_gaze_tracked(XrTime time) const;
    void note_change(const XrEventDataReferenceSpaceChangePending& event, std::optional<TrackingChange>& change) const;
    void begin_session();
    void end_session();
    void on_state_changed(const XrEventDataSessionStateChanged& event);
    const Runtime& runtime_;
    const gpu::Device& device_;
    XrOwnedSession session_;
    XrOwnedSpace tracking_, head_, gaze_;  // gaze_: null where narrow views do not follow it
    XrReferenceSpaceType tracking_type_ = XR_REFERENCE_SPACE_TYPE_STAGE;
    XrReferenceSpaceType centred_type_ = XR_REFERENCE_SPACE_TYPE_LOCAL;  // the space that recentring moves
    std::vector<XrReferenceSpaceType> spaces_;                           // that the runtime offers
    Pose reference_from_tracking_;
    bool knows_floor_ = false;
    XrSessionState state_ = XR_SESSION_STATE_UNKNOWN;
    bool running_ = false, ended_ = false, lost_ = false;
    std::optional<EyeViews> last_eyes_;
};

}  // namespace neuvv::xr

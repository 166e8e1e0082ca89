// A session with the headset: its states, where its user is, and frames in the runtime's time.
//
//     poll ─► wait ─► begin ─► locate ─► draw ─► end
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "xr/pose.h"
#include "xr/runtime.h"

namespace neuvv::xr {

Pose pose_of(const XrPosef& pose);
XrPosef xr_pose(const Pose& pose);

// What goes on, after its events.
enum class SessionDoes {
    kWait,  // nothing is to be drawn: poll again soon
    kRun,   // frames
    kEnd,   // the user or the runtime wants an end
    kLost,  // this session is of no more use; another one may be
};

// What the events of a poll said besides.
struct SessionNews {
    bool controllers = false;        // other ones are held: Actions::look_at_controllers
    std::array<bool, kEyes> mask{};  // the lens of an eye hides another part of it
};

constexpr double kEyesAbove_m = 1.6;

struct FrameTime {
    XrTime display = 0;     // when its light reaches the eyes, ns of the runtime's time
    XrDuration period = 0;  // of the display
    bool render = false;    // else the images would not be seen
};

struct EyeView {
    Pose pose;  // in tracking space
    XrFovf fov{};
};
struct EyeViews {
    std::array<EyeView, kEyes> eye;
};
// Whether angles span an image: each within 89.4° of the axis.
bool spans_image(const XrFovf& fov);

class Session {
  public:
    // Both must outlive it. Throws XrFailure.
    Session(const Runtime& runtime, const gpu::Device& device);

    XrSession handle() const { return session_.get(); }
    const Runtime& runtime() const { return runtime_; }
    // STAGE: its origin lies on the floor in the middle of where the user may walk. Where the runtime knows no floor:
    // kEyesAbove_m below LOCAL's origin, which is at the height of the eyes.
    XrSpace tracking_space() const { return tracking_.get(); }
    bool knows_floor() const { return knows_floor_; }
    XrSpace head_space() const { return head_.get(); }

    // Takes all events, begins and ends the session as they want it.
    SessionDoes poll(SessionNews& news);
    // Asks the runtime for an end, which comes as kEnd.
    void request_exit();

    // Throttles to the display. Throws XrFailure, also where the session is lost; poll() tells then.
    FrameTime wait();
    void begin();
    // Layers in the order in which they cover each other; none: nothing new is shown.
    void end(const FrameTime& time, std::span<const XrCompositionLayerBaseHeader* const> layers);

    // Where the eyes will be. While the head is not tracked, or eyes have angles that span nothing: where they were
    // last; nothing before they ever were anywhere.
    std::optional<EyeViews> locate_eyes(XrTime time);
    // Where a space is in the tracking space; nothing while it is not known.
    std::optional<Pose> locate(XrSpace space, XrTime time) const;

    // Rates that the display knows, Hz; none where they cannot be chosen.
    std::vector<float> refresh_rates() const;
    void request_refresh_rate(float hz);

  private:
    void make_spaces();
    void begin_session();
    void end_session();
    void changed(const XrEventDataSessionStateChanged& event);
    const Runtime& runtime_;
    const gpu::Device& device_;
    XrOwnedSession session_;
    XrOwnedSpace tracking_, head_;
    bool knows_floor_ = false;
    XrSessionState state_ = XR_SESSION_STATE_UNKNOWN;
    bool running_ = false, ended_ = false, lost_ = false;
    std::optional<EyeViews> last_eyes_;
};

}  // namespace neuvv::xr

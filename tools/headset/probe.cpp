#include "tools/headset/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "tools/headset/draw/eye_images.h"
#include "xr/actions.h"
#include "xr/draw/eye_camera.h"
#include "xr/hand_tracking.h"
#include "xr/newer_types.h"

namespace neuvv::headset {

namespace {

constexpr auto kMost = std::chrono::seconds(4);
constexpr int kFramesOfFocus = 30;  // in which a runtime finds controllers that are switched on

class Prober {
  public:
    Prober(const xr::Runtime& runtime, const gpu::Device& device)
        : runtime_(runtime), device_(device), session_(runtime, device), actions_(session_, false), hands_(session_) {}

    HeadsetProbe run() {
        {
            const EyeImages eyes(device_, session_, {});
            found_.images = fmt::format("{}x{} a view, {}", eyes.size().width, eyes.size().height, eyes.format_name());
        }
        found_.floor = session_.floor_title();
        found_.refresh_rates = session_.refresh_rates();
        const auto begin = std::chrono::steady_clock::now();
        bool asked_to_end = false;
        for (;;) {
            xr::SessionEvents events;
            const xr::SessionStatus status = session_.poll(events);
            if (status == xr::SessionStatus::kEnded || status == xr::SessionStatus::kLost) break;
            const bool too_long = std::chrono::steady_clock::now() - begin > kMost;
            if (too_long && asked_to_end) break;  // a runtime that does not end its session
            if ((too_long || focused_ >= kFramesOfFocus) && !std::exchange(asked_to_end, true)) session_.request_exit();
            if (status == xr::SessionStatus::kRunning)
                frame();
            else
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        find_idle();
        return found_;
    }

  private:
    void frame() {
        const xr::FrameTime time = session_.wait_frame();
        session_.begin_frame();
        const xr::HandInputs inputs = actions_.sample(time.display);
        if (session_.has_focus()) {
            ++focused_;
            found_.had_focus = true;
            actions_.update_controllers();
            hands_.locate(time.display);
            note(inputs, actions_.locate_trackers(time.display));
        }
        session_.end_frame(time, runtime_.blend_modes()[0], {});
    }

    void note(const xr::HandInputs& inputs, const xr::TrackerPositions& trackers) {
        for (const int hand : {xr::kLeft, xr::kRight}) {
            if (const std::string name = actions_.controller(hand); !name.empty()) found_.controllers[hand] = name;
            found_.are_located[hand] |= inputs[hand].grip || inputs[hand].aim;
            found_.bare_hands[hand] |= !hands_.joints(hand).empty();
        }
        std::vector<std::string> worn;
        for (size_t i = 0; i < trackers.size(); ++i) {
            const std::string role = xr::kTrackerRoles[i].path;
            if (trackers[i]) worn.push_back(role.substr(role.rfind('/') + 1));
        }
        if (worn.size() > found_.trackers.size()) found_.trackers = std::move(worn);
    }

    void find_idle() {
        const auto note_idle = [&](const char* extension, bool works) {
            if (runtime_.supports(extension) && !works) found_.idle.emplace_back(extension);
        };
        note_idle(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME, found_.refresh_rates.size() > 1);
        note_idle(xr::kLocalFloorExtension, session_.offers(xr::kLocalFloorSpace));
        constexpr XrFovf kAny{-0.7f, 0.7f, 0.7f, -0.7f};
        note_idle(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME, !xr::hidden_triangles(session_, 0, kAny).empty());
        const bool sees_hands = runtime_.supports(XR_EXT_HAND_TRACKING_EXTENSION_NAME);
        const auto is_hand = [&](int hand) { return found_.controllers[hand].find("hands") != std::string::npos; };
        for (const char* gestures : {xr::kHandInteraction, XR_MSFT_HAND_INTERACTION_EXTENSION_NAME})
            note_idle(gestures, sees_hands || is_hand(xr::kLeft) || is_hand(xr::kRight));
        if (found_.had_focus) note_idle(XR_HTCX_VIVE_TRACKER_INTERACTION_EXTENSION_NAME, !found_.trackers.empty());
    }

    const xr::Runtime& runtime_;
    const gpu::Device& device_;
    xr::Session session_;
    xr::Actions actions_;
    xr::HandTracking hands_;
    HeadsetProbe found_;
    int focused_ = 0;
};

}  // namespace

HeadsetProbe probe_headset(const xr::Runtime& runtime, const gpu::Device& device) {
    return Prober(runtime, device).run();
}

}  // namespace neuvv::headset

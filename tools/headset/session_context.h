// A session with its input and its images, and what happens in a frame of it.
#pragma once

#include <memory>
#include <optional>

#include "tools/headset/draw/mirror.h"
#include "tools/headset/hands/labels.h"
#include "tools/headset/panel/panel.h"
#include "tools/headset/panel/panel_surface.h"
#include "tools/headset/runtime_context.h"
#include "tools/headset/wearer.h"
#include "xr/actions.h"
#include "xr/room.h"

namespace neuvv::headset {

struct SessionContext {
    SessionContext(Program& program, RuntimeContext& context)
        : xr_session(context.runtime, context.device),
          actions(xr_session, program.options.quality.inset && !context.runtime.has_narrow_views()),
          hand_tracking(xr_session),
          room(xr_session),
          eyes(context.device, xr_session, program.options.quality),
          panel(context.device, xr_session),
          font(context.device) {
        eyes.set_font(font.image());
        if (const auto area = xr_session.play_area()) room_m = *area;
    }
    xr::Session xr_session;
    xr::Actions actions;
    xr::HandTracking hand_tracking;
    std::optional<WearerBody> body;  // once it is needed
    xr::Room room;
    EyeImages eyes;
    PanelSurface panel;
    LabelFont font;  // the panel's
    std::unique_ptr<Mirror> mirror;
    xr::EyeShapes shapes;
    std::optional<xr::TrackingChange> tracking_change;  // that is to come
    glm::dvec2 room_m = PanelStatus{}.room_m;           // width and depth of the room's free floor
    // The last time that the head seemed to jump, and where it came from (tracking space).
    struct HeadJump {
        XrTime at = 0;
        xr::Pose from;
    };
    std::optional<HeadJump> head_jump;
    XrTime last_display = 0;
    double images_per_second = 0;
};

// Does what a poll of the session reported.
void handle_events(const xr::SessionEvents& events, Program& program, SessionContext& session);
// Waits for the next frame, does what hands do in it, and draws it.
void frame(Program& program, RuntimeContext& context, SessionContext& session);

}  // namespace neuvv::headset

// A session's life: states, events, and what the script makes of them.
#pragma once

#include <cstring>

#include "state.h"

namespace neuvv::xr_runtime {

// `T` is one of the XrEventData structs, its type set.
template <typename T>
void queue_event(Instance& instance, const T& event) {
    static_assert(sizeof(T) <= sizeof(XrEventDataBuffer));
    std::memcpy(&instance.events.emplace_back(), &event, sizeof event);
}

// To another state, with its event, and the report's line.
void enter_state(Session& session, XrSessionState state);
// Step by step between SYNCHRONIZED, VISIBLE and FOCUSED.
void walk_to(Session& session, XrSessionState state);
// Down to STOPPING. What follows xrEndSession is said by `after`.
void stop_session(Session& session, AfterStop after);
// xrPollEvent found nothing: brings READY again for sessions that restart.
void pass_idle_poll(Session& session);
// Swapchains, spaces and all.
void destroy_session_now(Session& session);

// With the event of XR_FB_display_refresh_rate, where that is enabled.
void set_refresh_rate(Session& session, float hz);

// What the script has for a frame that xrWaitFrame is about to give.
void play_events(Session& session, int64_t frame);

}  // namespace neuvv::xr_runtime

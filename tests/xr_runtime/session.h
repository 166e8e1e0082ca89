// The life cycle of a session: states, events, and how the script changes them.
#pragma once

#include <cstring>

#include "state.h"

namespace neuvv::xr_runtime {

// `T` is one of the XrEventData structs; its type must be set.
template <typename T>
void queue_event(Instance& instance, const T& event) {
    static_assert(sizeof(T) <= sizeof(XrEventDataBuffer));
    std::memcpy(&instance.events.emplace_back(), &event, sizeof event);
}

// Enters a state, queues its event and adds it to the report.
void enter_state(Session& session, XrSessionState state);
// Goes to a state step by step, between SYNCHRONIZED, VISIBLE and FOCUSED.
void walk_to(Session& session, XrSessionState state);
// Goes to STOPPING; `after` says what follows xrEndSession.
void stop_session(Session& session, AfterStop after);
// To be called when xrPollEvent finds no event: sessions that restart become READY again after some such calls.
void pass_idle_poll(Session& session);
// Destroys the session with all its swapchains, spaces and other objects.
void destroy_session_now(Session& session);

// Changes the refresh rate, with the event of XR_FB_display_refresh_rate where that is enabled.
void set_refresh_rate(Session& session, float hz);

// Does what the script demands at a frame that xrWaitFrame is about to return.
void play_events(Session& session, int64_t frame);

}  // namespace neuvv::xr_runtime

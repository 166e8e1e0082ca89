// What a headset really has, which the extensions of its runtime do not tell: found by a short session without images.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "xr/hands.h"
#include "xr/runtime.h"

namespace neuvv::headset {

struct HeadsetProbe {
    bool had_focus = false;  // else the runtime names no controllers, as nobody wears the headset or its menu is open
    std::array<std::string, xr::kHands> controllers;  // by hand; empty: none
    std::array<bool, xr::kHands> are_located{};       // whether the runtime knows where each controller is
    std::array<bool, xr::kHands> bare_hands{};        // whether its joints are seen
    std::vector<std::string> trackers;                // where worn ones are
    std::string images;                               // the size and the format of a view's
    std::string floor;                                // how it is known
    std::vector<float> refresh_rates;                 // Hz; empty: the runtime does not say
    // Extensions that the runtime offers, and that do nothing with this headset.
    std::vector<std::string> idle;
};

// Runs a session for some seconds at most. Throws XrFailure.
HeadsetProbe probe_headset(const xr::Runtime& runtime, const gpu::Device& device);

}  // namespace neuvv::headset

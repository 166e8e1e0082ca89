// A stage in a headset: the loop from frame to frame, and what begins anew when a session or the runtime is lost.
//
//     Runtime ─► Device ─► StageRenderer ─► Session ─► frame: wait ─► hands ─► stage ─► eyes ─► end
//        ▲                                     ▲                                              │
//        └────────── instance lost ────────────┴─────────────── session lost ─────────────────┘
//
// Document, history, time and the user's place outlive both.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "editor/document_saver.h"
#include "tools/headset/eye_images.h"

namespace neuvv::headset {

struct HeadsetOptions {
    std::filesystem::path file;
    std::string device;
    EyeQuality quality;
    std::optional<double> refresh_hz;
    bool mirror = false, validate = false, recover = false, play = false;
    std::filesystem::path
        report;           // what was seen last and where its buttons are, for programs that drive it; empty: none
    double retry_s = 20;  // for so long a lost runtime is waited for
};

// Until its user leaves. Throws RuntimeFailure or InputError, in a line; unsaved edits are stored by then.
void watch_in_headset(const HeadsetOptions& options);

}  // namespace neuvv::headset

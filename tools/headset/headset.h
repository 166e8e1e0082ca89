// A stage in a headset: the frame loop, and recovery where a session, the runtime or the device is lost.
//
//     Runtime ─► Device ─► StageRenderer ─► Session ─► frame: wait ─► hands ─► stage ─► eyes ─► end
//        ▲                                     ▲                                              │
//        └───── instance or device lost ───────┴─────────────── session lost ─────────────────┘
//
// Document, history, time and the user's position outlive both.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "editor/document_saver.h"
#include "tools/headset/draw/eye_images.h"

namespace neuvv::headset {

struct HeadsetOptions {
    std::filesystem::path file;
    std::string device;
    std::string trainee;  // the address of a motion::PoseSource with which coaching begins at once; empty: none
    EyeQuality quality;
    std::optional<double> refresh_hz;
    xr::ViewChoice views = xr::ViewChoice::kAsOffered;
    bool room = false;  // show the user's own room from the start
    bool mirror = false, validate = false, recover = false, play = false;
    // Where to write, at the end, the last state and the positions of the panel's buttons, for programs that drive this
    // one; empty: nowhere.
    std::filesystem::path report;
    double retry_s = 120;  // timeout: how long to wait for a lost runtime, which users start again by hand
};

// Returns when the user leaves. Throws RuntimeFailure or InputError with a message of one line; unsaved edits have been
// stored by then.
void run_headset(const HeadsetOptions& options);

}  // namespace neuvv::headset

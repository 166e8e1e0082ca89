// The report on what an application did: report.json in NEUVV_XR_OUT, see README.md.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "openxr_all.h"

namespace neuvv::xr_runtime {

// A finding is reported once, however often it happens.
struct Finding {
    int64_t frame;  // when it happened first
    std::string function, rule, text;
    int64_t count;
};

struct HapticPulse {
    int64_t frame;
    std::string path;
    float amplitude;
    XrDuration duration_ns;
};

struct SavedLayers {
    int64_t frame;
    std::vector<std::string> types;
    bool has_depth;
    XrTime display_time;
    int64_t format;           // of the last projection layer's left image; 0 without one
    XrExtent2Di size;         // of its imageRect
    std::string blend;        // the environment blend mode, as the script names it
    std::vector<XrFovf> fov;  // of its views
};

struct Report {
    std::filesystem::path folder;  // where to write; empty: nowhere
    std::vector<Finding> violations, warnings;
    int64_t frames = 0, frames_with_layers = 0;
    std::vector<std::string> states;
    std::vector<HapticPulse> haptics;
    std::vector<SavedLayers> layers;
    std::vector<std::string> actions;
    struct Binding {
        std::string action, path;
    };
    std::map<std::string, std::vector<Binding>> bindings;  // by interaction profile
    std::vector<int64_t> resident_bytes;                   // of the process, each time that it created an instance
    bool is_destroyed_cleanly = false;

    // Both return whether the finding is new.
    bool add_violation(Finding finding);
    bool add_warning(Finding finding);
    // Replaces the file atomically; a failure is reported on stderr.
    void write() const;
};

}  // namespace neuvv::xr_runtime

// What the viewer remembers between runs, as JSON in config_folder()/"viewer.json".
//
//   {"window": {"width": 1600, "height": 900, "x": 40, "y": 30, "maximised": false},
//    "recent": ["/home/me/a.gltf"], "panels": {"stage": {"open": true, "width": 320}},
//    "uiScale": 1, "preview": {"resolution": 1, "samples": 4}, "layer": "colour"}
//
// Every member may be missing. Members that are not known here stay in the file, in all of these objects.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/ui/window_geometry.h"

namespace neuvv::viewer {

constexpr size_t kMaxRecentFiles = 10;

struct PanelSize {
    bool open = true;
    double width = 320;  // in units of the interface, 50 to 4096
};

struct PreviewQuality {
    double resolution = 1;  // share of the window's, 0.2 to 1
    uint32_t samples = 4;   // a pixel, at rest; 1 to 64
};

struct Preferences {
    ui::WindowGeometry window;
    std::vector<std::filesystem::path> recent;  // absolute, each once, newest first, at most kMaxRecentFiles
    std::map<std::string, PanelSize> panels;    // by their names, at most 64; others leave the file
    double ui_scale = 1;                        // 0.5 to 4
    PreviewQuality preview;
    std::string layer;  // of the image that is shown, by its name; empty: the first
    nlohmann::ordered_json document = nlohmann::ordered_json::object();  // as it was read: for what is not known here
};

struct LoadedPreferences {
    Preferences preferences;
    std::string message;  // one line for the user about what was wrong; empty: nothing
};

// Never throws for what is in the file or where it should be: what is missing has its default, and what is damaged or
// out of range, too, with a message that names it.
LoadedPreferences load_preferences(const std::filesystem::path& path);

// Atomically, its folder made where it is missing. Paths that are not UTF-8 are left out. Throws RuntimeFailure.
void save_preferences(const std::filesystem::path& path, const Preferences& preferences);

// A file was opened or saved: it comes first.
void remember_file(Preferences& preferences, const std::filesystem::path& file);

// Of the same order and length as `recent`: whether each is still there. Files that are gone stay listed: a disk may
// come back.
std::vector<bool> recent_files_there(const Preferences& preferences);

}  // namespace neuvv::viewer

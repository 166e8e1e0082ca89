// What the viewer remembers between runs, as JSON in config_folder()/"viewer.json".
//
//   {"window": {"width": 1600, "height": 900, "x": 40, "y": 30, "maximised": false},
//    "recent": ["/home/me/a.gltf"], "panels": {"stage": {"open": true, "width": 320}},
//    "uiScale": 1, "preview": {"resolution": 1, "samples": 4, "farLevels": true}, "layer": "colour"}
//
// Every member may be missing. Members of these objects that the viewer does not know stay in the file.
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
    double width = 320;  // pixels at scale 1, 50 to 4096
};

struct PreviewQuality {
    double resolution = 1;  // while something moves: the most rays per pixel along each side, 0.2 to 1
    uint32_t samples = 4;   // while nothing moves: rays per pixel, 1 to 64
    bool far_levels = true;
};

struct Preferences {
    ui::WindowGeometry window;
    std::vector<std::filesystem::path> recent;  // absolute, each once, newest first, at most kMaxRecentFiles
    std::map<std::string, PanelSize> panels;    // by name, at most 64; saving removes all others from the file
    double ui_scale = 1;                        // 0.5 to 4
    PreviewQuality preview;
    std::string layer;  // the displayed layer of the image, by name (kLayerNames); empty: the first
    nlohmann::ordered_json document = nlohmann::ordered_json::object();  // as it was read, unknown members included
};

struct LoadedPreferences {
    Preferences preferences;
    std::string message;  // one line for the user that says what is wrong in the file; empty: nothing
};

// Never throws because of the file's contents or because it is missing: a missing member has its default. So has a
// damaged member, or one that is out of range, and the message names it.
LoadedPreferences load_preferences(const std::filesystem::path& path);

// Replaces the file atomically, and creates its folder where that is missing. Paths that are not UTF-8 are left out.
// Throws RuntimeFailure.
void save_preferences(const std::filesystem::path& path, const Preferences& preferences);

// To be called when a file was opened or saved. It becomes the first of `recent`.
void remember_file(Preferences& preferences, const std::filesystem::path& file);

// For each file of `recent`, in that order: whether it exists. Files that do not exist stay in the list, because their
// disk may come back.
std::vector<bool> recent_files_exist(const Preferences& preferences);

}  // namespace neuvv::viewer

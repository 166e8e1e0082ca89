#include "tools/viewer/preferences.h"

#include <fmt/format.h>

#include <algorithm>

#include "editor/preference_file.h"
#include "stream/transport/byte_source.h"

namespace neuvv::viewer {

namespace {

using nlohmann::ordered_json;

constexpr size_t kMaxPanels = 64;

void read_window(editor::PreferenceReader& reader, const ordered_json& json, ui::WindowGeometry& window) {
    reader.number(json, "window.", "width", 320, 16384, window.width);
    reader.number(json, "window.", "height", 320, 16384, window.height);
    int x = 0, y = 0;
    const bool has_x = reader.number(json, "window.", "x", -32768, 32767, x);
    if (reader.number(json, "window.", "y", -32768, 32767, y) && has_x) window.at = {x, y};
    reader.boolean(json, "window.", "maximised", window.maximised);
}

void read_recent(editor::PreferenceReader& reader, const ordered_json& document, Preferences& preferences) {
    const ordered_json* list = editor::PreferenceReader::find(document, "recent");
    if (!list) return;
    if (!list->is_array()) {
        reader.wrong.emplace_back("recent");
        return;
    }
    // The newest file comes first in the list, so it has to be remembered last.
    for (size_t i = std::min(list->size(), kMaxRecentFiles); i-- > 0;) {
        std::string file;
        const std::string member = fmt::format("recent[{}]", i);
        if (!reader.text((*list)[i], member, file)) continue;
        if (stream::is_address(file) || std::filesystem::path(file).is_absolute())
            remember_file(preferences, file);
        else
            reader.wrong.push_back(member);
    }
}

void read_panels(editor::PreferenceReader& reader, const ordered_json& panels, Preferences& preferences) {
    for (const auto& [name, json] : panels.items()) {
        if (preferences.panels.size() == kMaxPanels || name.size() > editor::PreferenceReader::kMaxText ||
            !json.is_object()) {
            reader.wrong.emplace_back("panels");
            return;
        }
        PanelSize& panel = preferences.panels[name];
        reader.boolean(json, "panels.", "open", panel.open);
        reader.number(json, "panels.", "width", 50.0, 4096.0, panel.width);
    }
}

Preferences read_document(editor::PreferenceReader& reader, ordered_json document) {
    Preferences preferences;
    read_window(reader, reader.object(document, "window"), preferences.window);
    read_recent(reader, document, preferences);
    read_panels(reader, reader.object(document, "panels"), preferences);
    reader.number(document, "", "uiScale", 0.5, 4.0, preferences.ui_scale);
    const ordered_json& preview = reader.object(document, "preview");
    reader.number(preview, "preview.", "resolution", 0.2, 1.0, preferences.preview.resolution);
    reader.number(preview, "preview.", "samples", 1u, 64u, preferences.preview.samples);
    reader.boolean(preview, "preview.", "farLevels", preferences.preview.far_levels);
    if (const ordered_json* layer = editor::PreferenceReader::find(document, "layer"))
        reader.text(*layer, "layer", preferences.layer);
    preferences.document = std::move(document);
    return preferences;
}

// JSON cannot hold other bytes: their path would be read back as that of another file.
bool is_utf8(const std::string& text) {
    using Handler = ordered_json::error_handler_t;
    const ordered_json json(text);
    return json.dump(-1, ' ', false, Handler::ignore) == json.dump(-1, ' ', false, Handler::replace);
}

ordered_json json_of(const Preferences& preferences) {
    ordered_json document = preferences.document.is_object() ? preferences.document : ordered_json::object();
    ordered_json& window = editor::object_in(document, "window");
    window["width"] = preferences.window.width;
    window["height"] = preferences.window.height;
    window.erase("x");
    window.erase("y");
    if (preferences.window.at) {
        window["x"] = preferences.window.at->first;
        window["y"] = preferences.window.at->second;
    }
    window["maximised"] = preferences.window.maximised;
    document["recent"] = ordered_json::array();
    for (const std::filesystem::path& file : preferences.recent)
        if (is_utf8(file.string())) document["recent"].push_back(file.string());
    ordered_json panels = ordered_json::object();
    for (const auto& [name, panel] : preferences.panels) {
        ordered_json json = editor::object_in(editor::object_in(document, "panels"), name);
        json["open"] = panel.open;
        json["width"] = panel.width;
        panels[name] = std::move(json);
    }
    document["panels"] = std::move(panels);
    document["uiScale"] = preferences.ui_scale;
    ordered_json& preview = editor::object_in(document, "preview");
    preview["resolution"] = preferences.preview.resolution;
    preview["samples"] = preferences.preview.samples;
    preview["farLevels"] = preferences.preview.far_levels;
    document["layer"] = preferences.layer;
    return document;
}

}  // namespace

LoadedPreferences load_preferences(const std::filesystem::path& path) {
    editor::PreferenceFile file = editor::load_preference_file(path);
    editor::PreferenceReader reader;
    LoadedPreferences loaded{read_document(reader, std::move(file.document)), std::move(file.message)};
    if (loaded.message.empty()) loaded.message = editor::wrong_members(path, reader.wrong);
    return loaded;
}

void save_preferences(const std::filesystem::path& path, const Preferences& preferences) {
    editor::save_preference_file(path, json_of(preferences));
}

void remember_file(Preferences& preferences, const std::filesystem::path& file) {
    const std::filesystem::path whole =
        stream::is_address(file) ? file : std::filesystem::absolute(file).lexically_normal();
    std::erase(preferences.recent, whole);
    preferences.recent.insert(preferences.recent.begin(), whole);
    if (preferences.recent.size() > kMaxRecentFiles) preferences.recent.resize(kMaxRecentFiles);
}

std::vector<bool> recent_files_exist(const Preferences& preferences) {
    std::vector<bool> exist;
    for (const std::filesystem::path& file : preferences.recent) {
        std::error_code ignored;
        exist.push_back(stream::is_address(file) || std::filesystem::is_regular_file(file, ignored));
    }
    return exist;
}

}  // namespace neuvv::viewer

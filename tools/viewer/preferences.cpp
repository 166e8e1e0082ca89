#include "tools/viewer/preferences.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/platform.h"
#include "tools/report.h"

namespace neuvv {

namespace {

using nlohmann::ordered_json;

constexpr uint64_t kMaxBytes = uint64_t{1} << 20;
constexpr int kMaxDepth = 32;  // of brackets: copying and writing JSON goes as deep as it is
constexpr size_t kMaxText = 4096, kMaxPanels = 64, kMaxNamed = 5;

// Reads members that may be missing or anything, and remembers which were wrong.
struct Reader {
    std::vector<std::string> wrong;

    // The member, if it is there; what is not an object has none.
    static const ordered_json* find(const ordered_json& object, const char* name) {
        const auto found = object.is_object() ? object.find(name) : object.end();
        return object.is_object() && found != object.end() ? &*found : nullptr;
    }
    const ordered_json& object(const ordered_json& parent, const char* name) {
        static const ordered_json kNone = ordered_json::object();
        const ordered_json* member = find(parent, name);
        if (!member) return kNone;
        if (!member->is_object()) wrong.emplace_back(name);
        return member->is_object() ? *member : kNone;
    }
    template <typename Number>
    bool number(const ordered_json& object, const std::string& place, const char* name, Number low, Number high,
                Number& value) {
        const ordered_json* member = find(object, name);
        if (!member) return false;
        const double read = member->is_number() ? member->get<double>() : NAN;
        const bool sound = read >= static_cast<double>(low) && read <= static_cast<double>(high);
        if (sound)
            value = static_cast<Number>(read);
        else
            wrong.push_back(place + name);
        return sound;
    }
    void boolean(const ordered_json& object, const std::string& place, const char* name, bool& value) {
        const ordered_json* member = find(object, name);
        if (!member) return;
        if (member->is_boolean())
            value = member->get<bool>();
        else
            wrong.push_back(place + name);
    }
    // Short enough, and without zeros, which would end it in the middle.
    bool text(const ordered_json& json, const std::string& place, std::string& value) {
        const std::string* read = json.is_string() ? json.get_ptr<const std::string*>() : nullptr;
        const bool sound = read && read->size() <= kMaxText && read->find('\0') == std::string::npos;
        if (sound)
            value = *read;
        else
            wrong.push_back(place);
        return sound;
    }
};

void read_window(Reader& reader, const ordered_json& json, WindowPlace& window) {
    reader.number(json, "window.", "width", 320, 16384, window.width);
    reader.number(json, "window.", "height", 320, 16384, window.height);
    int x = 0, y = 0;
    const bool has_x = reader.number(json, "window.", "x", -32768, 32767, x);
    if (reader.number(json, "window.", "y", -32768, 32767, y) && has_x) window.at = {x, y};
    reader.boolean(json, "window.", "maximised", window.maximised);
}

void read_recent(Reader& reader, const ordered_json& document, Preferences& preferences) {
    const ordered_json* list = Reader::find(document, "recent");
    if (!list) return;
    if (!list->is_array()) {
        reader.wrong.emplace_back("recent");
        return;
    }
    // The newest stand first: remembered last, they come first again.
    for (size_t i = std::min(list->size(), kMaxRecentFiles); i-- > 0;) {
        std::string file;
        const std::string place = fmt::format("recent[{}]", i);
        if (!reader.text((*list)[i], place, file)) continue;
        if (std::filesystem::path(file).is_absolute())
            remember_file(preferences, file);
        else
            reader.wrong.push_back(place);
    }
}

void read_panels(Reader& reader, const ordered_json& panels, Preferences& preferences) {
    for (const auto& [name, json] : panels.items()) {
        if (preferences.panels.size() == kMaxPanels || name.size() > kMaxText || !json.is_object()) {
            reader.wrong.emplace_back("panels");
            return;
        }
        PanelPlace& panel = preferences.panels[name];
        reader.boolean(json, "panels.", "open", panel.open);
        reader.number(json, "panels.", "width", 50.0, 4096.0, panel.width);
    }
}

Preferences read_document(Reader& reader, ordered_json document) {
    Preferences preferences;
    read_window(reader, reader.object(document, "window"), preferences.window);
    read_recent(reader, document, preferences);
    read_panels(reader, reader.object(document, "panels"), preferences);
    reader.number(document, "", "uiScale", 0.5, 4.0, preferences.ui_scale);
    const ordered_json& preview = reader.object(document, "preview");
    reader.number(preview, "preview.", "resolution", 0.2, 1.0, preferences.preview.resolution);
    reader.number(preview, "preview.", "samples", 1u, 64u, preferences.preview.samples);
    if (const ordered_json* layer = Reader::find(document, "layer")) reader.text(*layer, "layer", preferences.layer);
    preferences.document = std::move(document);
    return preferences;
}

// Discarded where it is no JSON, and where it is nested too deeply.
ordered_json parse(const std::vector<uint8_t>& bytes) {
    bool deep = false;
    const auto shallow = [&](int depth, ordered_json::parse_event_t, ordered_json&) {
        deep |= depth > kMaxDepth;
        return !deep;
    };
    ordered_json document = ordered_json::parse(bytes, shallow, false);
    return deep ? ordered_json(ordered_json::value_t::discarded) : document;
}

// An object to write members into, over what stood there.
ordered_json& object_in(ordered_json& parent, const std::string& name) {
    ordered_json& member = parent[name];
    if (!member.is_object()) member = ordered_json::object();
    return member;
}

// Bytes that are no UTF-8 would come back as another file.
bool is_utf8(const std::string& text) {
    using Handler = ordered_json::error_handler_t;
    const ordered_json json(text);
    return json.dump(-1, ' ', false, Handler::ignore) == json.dump(-1, ' ', false, Handler::replace);
}

ordered_json written(const Preferences& preferences) {
    ordered_json document = preferences.document.is_object() ? preferences.document : ordered_json::object();
    ordered_json& window = object_in(document, "window");
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
        ordered_json json = object_in(object_in(document, "panels"), name);
        json["open"] = panel.open;
        json["width"] = panel.width;
        panels[name] = std::move(json);
    }
    document["panels"] = std::move(panels);
    document["uiScale"] = preferences.ui_scale;
    ordered_json& preview = object_in(document, "preview");
    preview["resolution"] = preferences.preview.resolution;
    preview["samples"] = preferences.preview.samples;
    document["layer"] = preferences.layer;
    return document;
}

std::string wrong_members(const std::filesystem::path& path, const std::vector<std::string>& wrong) {
    std::string names;
    for (size_t i = 0; i < std::min(wrong.size(), kMaxNamed); ++i) names += (i ? ", " : "") + wrong[i];
    if (wrong.size() > kMaxNamed) names += fmt::format(" and {} more", wrong.size() - kMaxNamed);
    return fmt::format("{}: not understood, so defaults are used: {}", path.string(), names);
}

}  // namespace

LoadedPreferences load_preferences(const std::filesystem::path& path) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (status.type() == std::filesystem::file_type::not_found) return {};
    const auto defaults = [&](const std::string& problem) {
        return LoadedPreferences{{}, fmt::format("{}: {}; defaults are used", path.string(), problem)};
    };
    if (status.type() != std::filesystem::file_type::regular) return defaults("is not a file that can be read");
    try {
        ordered_json document = parse(read_file(path, kMaxBytes));
        if (!document.is_object()) return defaults("is damaged");
        Reader reader;
        LoadedPreferences loaded{read_document(reader, std::move(document)), ""};
        if (!reader.wrong.empty()) loaded.message = wrong_members(path, reader.wrong);
        return loaded;
    } catch (const InputError& error) {
        return {{}, std::string(error.what()) + "; defaults are used"};
    }
}

void save_preferences(const std::filesystem::path& path, const Preferences& preferences) {
    std::error_code failed;
    std::filesystem::create_directories(path.parent_path(), failed);  // writing tells what is wrong
    const std::string text = json_text(written(preferences));
    write_file_atomically(path, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

void remember_file(Preferences& preferences, const std::filesystem::path& file) {
    const std::filesystem::path whole = std::filesystem::absolute(file).lexically_normal();
    std::erase(preferences.recent, whole);
    preferences.recent.insert(preferences.recent.begin(), whole);
    if (preferences.recent.size() > kMaxRecentFiles) preferences.recent.resize(kMaxRecentFiles);
}

std::vector<bool> recent_files_there(const Preferences& preferences) {
    std::vector<bool> there;
    for (const std::filesystem::path& file : preferences.recent) {
        std::error_code ignored;
        there.push_back(std::filesystem::is_regular_file(file, ignored));
    }
    return there;
}

}  // namespace neuvv

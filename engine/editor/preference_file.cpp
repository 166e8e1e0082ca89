#include "editor/preference_file.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::editor {

namespace {

using nlohmann::ordered_json;

constexpr uint64_t kMaxBytes = uint64_t{1} << 20;
constexpr int kMaxDepth = 32;  // levels of brackets: copying and writing JSON recurse as deep as it is nested
constexpr size_t kMaxNamed = 5;

// The parsed document; discarded where the bytes are no JSON or are nested too deeply.
ordered_json parse(const std::vector<uint8_t>& bytes) {
    bool deep = false;
    const auto shallow = [&](int depth, ordered_json::parse_event_t, ordered_json&) {
        deep |= depth > kMaxDepth;
        return !deep;
    };
    ordered_json document = ordered_json::parse(bytes, shallow, false);
    return deep ? ordered_json(ordered_json::value_t::discarded) : document;
}

}  // namespace

const ordered_json* PreferenceReader::find(const ordered_json& object, const char* name) {
    const auto found = object.is_object() ? object.find(name) : object.end();
    return object.is_object() && found != object.end() ? &*found : nullptr;
}

const ordered_json& PreferenceReader::object(const ordered_json& parent, const char* name) {
    static const ordered_json kNone = ordered_json::object();
    const ordered_json* member = find(parent, name);
    if (!member) return kNone;
    if (!member->is_object()) wrong.emplace_back(name);
    return member->is_object() ? *member : kNone;
}

bool PreferenceReader::find_number(const ordered_json& object, const std::string& place, const char* name, double low,
                                   double high, double& value) {
    const ordered_json* member = find(object, name);
    if (!member) return false;
    value = member->is_number() ? member->get<double>() : NAN;
    const bool sound = value >= low && value <= high;
    if (!sound) wrong.push_back(place + name);
    return sound;
}

void PreferenceReader::boolean(const ordered_json& object, const std::string& place, const char* name, bool& value) {
    const ordered_json* member = find(object, name);
    if (!member) return;
    if (member->is_boolean())
        value = member->get<bool>();
    else
        wrong.push_back(place + name);
}

bool PreferenceReader::text(const ordered_json& json, const std::string& place, std::string& value) {
    const std::string* read = json.is_string() ? json.get_ptr<const std::string*>() : nullptr;
    const bool sound = read && read->size() <= kMaxText && read->find('\0') == std::string::npos;
    if (sound)
        value = *read;
    else
        wrong.push_back(place);
    return sound;
}

PreferenceFile load_preference_file(const std::filesystem::path& path) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (status.type() == std::filesystem::file_type::not_found) return {};
    PreferenceFile file;
    const auto defaults = [&](const std::string& problem) {
        file.message = fmt::format("{}: {}; defaults are used", path.string(), problem);
        return file;
    };
    if (status.type() != std::filesystem::file_type::regular) return defaults("is not a file that can be read");
    try {
        ordered_json document = parse(read_file(path, kMaxBytes));
        if (!document.is_object()) return defaults("is damaged");
        file.document = std::move(document);
    } catch (const InputError& error) {
        file.message = std::string(error.what()) + "; defaults are used";
    }
    return file;
}

std::string wrong_members(const std::filesystem::path& path, const std::vector<std::string>& wrong) {
    if (wrong.empty()) return {};
    std::string names;
    for (size_t i = 0; i < std::min(wrong.size(), kMaxNamed); ++i) names += (i ? ", " : "") + wrong[i];
    if (wrong.size() > kMaxNamed) names += fmt::format(" and {} more", wrong.size() - kMaxNamed);
    return fmt::format("{}: not understood, so defaults are used: {}", path.string(), names);
}

void save_preference_file(const std::filesystem::path& path, const ordered_json& document) {
    std::error_code failed;
    std::filesystem::create_directories(path.parent_path(), failed);  // the write below reports a failure
    const std::string text = document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
    write_file_atomically(path, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

ordered_json& object_in(ordered_json& parent, const std::string& name) {
    ordered_json& member = parent[name];
    if (!member.is_object()) member = ordered_json::object();
    return member;
}

}  // namespace neuvv::editor

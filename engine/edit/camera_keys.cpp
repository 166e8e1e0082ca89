// The stage's camera path. It is edited as JSON, so that members from later versions of this program are kept.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/document.h"
#include "edit/operations.h"
#include "stage/camera_path_json.h"

namespace neuvv::edit {

namespace {

double time_of(const ordered_json& key) {
    return key["time"].get<double>();
}

// The stage's cameraPath; null where it has none.
ordered_json* find_path(stage::StageFile& file) {
    ordered_json* stage = find_extension(scene_of(file), stage::kStageExtension);
    return stage && stage->contains("cameraPath") ? &(*stage)["cameraPath"] : nullptr;
}

ordered_json& make_path(stage::StageFile& file) {
    declare_extension(file, stage::kStageExtension);
    return make_extension(file, scene_of(file), stage::kStageExtension)["cameraPath"];
}

void remove_path(stage::StageFile& file) {
    ordered_json& scene = scene_of(file);
    ordered_json& stage = *find_extension(scene, stage::kStageExtension);
    stage.erase("cameraPath");
    if (stage.empty()) remove_extension(scene, stage::kStageExtension);
    undeclare_unused(file, stage::kStageExtension);
}

// The stage's path. Throws InputError where it has no such key.
ordered_json& path_with_key(stage::StageFile& file, size_t key) {
    ordered_json* path = find_path(file);
    const size_t count = path ? (*path)["keys"].size() : 0;
    if (key >= count)
        throw InputError(file.path.string(), "cameraPath", fmt::format("has no key {}", key),
                         count == 0 ? "it has none" : fmt::format("choose from 0 to {}", count - 1));
    return *path;
}

// The index of the key that is nearest to a time, within half a frame; keys.size() where there is none.
size_t key_at(const ordered_json& keys, double time_s, double frame_s) {
    size_t nearest = keys.size();
    double distance = 0.5 * frame_s;
    for (size_t i = 0; i < keys.size(); ++i)
        if (std::abs(time_of(keys[i]) - time_s) <= distance) {
            distance = std::abs(time_of(keys[i]) - time_s);
            nearest = i;
        }
    return nearest;
}

void insert_key(ordered_json& keys, ordered_json key) {
    const auto after = std::find_if(keys.begin(), keys.end(),
                                    [&](const ordered_json& other) { return time_of(other) > time_of(key); });
    keys.insert(after, std::move(key));
}

// Updates the duration of a path. An open path that ended with its last key, at `last_s`, still does. A cyclic path
// without time to return to its first key gets the mean time from key to key for that.
void set_duration(ordered_json& path, double last_s) {
    const ordered_json& keys = path["keys"];
    const double first = time_of(keys.front()), last = time_of(keys.back()), duration = path.value("duration", last_s);
    if (path.value("cyclic", false)) {
        const double mean = keys.size() > 1 ? (last - first) / static_cast<double>(keys.size() - 1) : 1;
        path["duration"] = duration > last ? duration : last + mean;
    } else if (path.contains("duration")) {
        path["duration"] = duration <= last_s ? last : std::max(duration, last);
    }
}

std::string summary_of(const ordered_json& path) {
    const size_t count = path["keys"].size();
    return fmt::format("camera path of {} {}, {:.6g} s", count, count == 1 ? "key" : "keys",
                       path.value("duration", time_of(path["keys"].back())));
}

// Throws InputError for keys whose lens has more than a vertical angle, which the path of a stage cannot express.
void expect_simple(const stage::StageFile& file, const stage::CameraPath& path) {
    for (size_t i = 0; i < path.keys.size(); ++i) {
        const stage::CameraPathKey& key = path.keys[i];
        if (key.angle_x || std::abs(key.stretch - 1) > 1e-6 || glm::length(key.shift) > 1e-6)
            throw InputError(file.path.string(), fmt::format("cameraPath/keys/{}", i),
                             "its lens has more than a vertical angle: another horizontal one, or a shifted centre",
                             "give square pixels, centred, and camera_angle_y; or render with the path's own file");
    }
}

}  // namespace

std::string set_camera_path(stage::StageFile& file, const std::optional<stage::CameraPath>& path) {
    return all_or_nothing(file, [&]() -> std::string {
        if (!path || path->keys.empty()) {
            if (find_path(file)) remove_path(file);
            return "no camera path";
        }
        expect_simple(file, *path);
        ordered_json& json = make_path(file);
        if (json.is_null()) json = ordered_json::object();
        const ordered_json old = json.value("keys", ordered_json::array());
        for (const char* name : {"interpolation", "cyclic"}) json.erase(name);
        json.update(stage::json_of(*path));
        for (ordered_json& key : json["keys"])
            if (const size_t same = key_at(old, time_of(key), 0); same < old.size()) {
                ordered_json kept = old[same];
                kept.update(key);
                key = std::move(kept);
            }
        return summary_of(json);
    });
}

std::string add_path_key(stage::StageFile& file, const stage::CameraPathKey& key, double frame_s) {
    return all_or_nothing(file, [&] {
        if (!find_path(file)) make_path(file) = {{"keys", ordered_json::array()}, {"duration", key.time_s}};
        ordered_json& path = *find_path(file);
        ordered_json& keys = path["keys"];
        const double last_s = keys.empty() ? key.time_s : time_of(keys.back());
        const size_t same = key_at(keys, key.time_s, frame_s);
        const bool replaces = same < keys.size();
        if (replaces)
            keys[same].update(stage::json_of(key));
        else
            insert_key(keys, stage::json_of(key));
        set_duration(path, last_s);
        return fmt::format("key at {:.6g} s {}; {}", key.time_s, replaces ? "replaced" : "added", summary_of(path));
    });
}

std::string remove_path_key(stage::StageFile& file, size_t key) {
    ordered_json& path = path_with_key(file, key);
    ordered_json& keys = path["keys"];
    const double time_s = time_of(keys[key]), last_s = time_of(keys.back());
    keys.erase(key);
    if (keys.empty()) {
        remove_path(file);
        return fmt::format("key at {:.6g} s removed; no camera path", time_s);
    }
    set_duration(path, last_s);
    return fmt::format("key at {:.6g} s removed; {}", time_s, summary_of(path));
}

std::string move_path_key(stage::StageFile& file, size_t key, double to_s, double frame_s) {
    ordered_json& path = path_with_key(file, key);
    ordered_json& keys = path["keys"];
    const double from_s = time_of(keys[key]), last_s = time_of(keys.back());
    ordered_json moved = keys[key];
    keys.erase(key);
    const size_t same = key_at(keys, to_s, frame_s);
    if (same < keys.size()) keys.erase(same);
    moved["time"] = to_s;
    insert_key(keys, std::move(moved));
    set_duration(path, last_s);
    return fmt::format("key moved from {:.6g} s to {:.6g} s; {}", from_s, to_s, summary_of(path));
}

}  // namespace neuvv::edit

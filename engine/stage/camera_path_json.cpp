#include "stage/camera_path_json.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/formats/json.h"
#include "stage/stage_settings.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

constexpr double kMaxPosition = 1e9;  // metres

// Reads a list of `count` numbers within ±limit. Throws InputError where it is missing or something else.
void read_numbers(const JsonMembers& members, const char* name, size_t count, double limit, double* values) {
    const ordered_json* found = members.find(name);
    const bool whole = found && found->is_array() && found->size() == count;
    for (size_t i = 0; i < count; ++i) {
        values[i] = whole && (*found)[i].is_number() ? (*found)[i].get<double>() : NAN;
        if (!(std::abs(values[i]) <= limit))
            throw InputError(members.file, members.place + "/" + name,
                             fmt::format("is not {} numbers within {}", count, limit));
    }
}

CameraPathKey key_of(const ordered_json& json, const std::string& file, const std::string& place) {
    const JsonMembers members(json, file, place);
    CameraPathKey key;
    for (const char* name : {"time", "yfov"})
        if (!members.find(name)) throw InputError(file, place, fmt::format("lacks \"{}\"", name));
    members.number("time", 0, kMaxStageSeconds, key.time_s);
    members.number("yfov", kMinPathAngle_rad, kMaxPathAngle_rad, key.angle_y);
    read_numbers(members, "position", 3, kMaxPosition, &key.position[0]);
    double q[4];
    read_numbers(members, "rotation", 4, 2, q);
    const glm::dquat rotation(q[3], q[0], q[1], q[2]);
    if (!(glm::length(rotation) > 1e-6)) throw InputError(file, place + "/rotation", "is a quaternion of length 0");
    key.world_from_camera = glm::normalize(rotation);
    return key;
}

}  // namespace

CameraPath camera_path_of(const ordered_json& json, const std::string& file, const std::string& place) {
    const JsonMembers members(json, file, place);
    CameraPath path;
    const ordered_json* keys = members.find("keys");
    if (!keys || !keys->is_array() || keys->empty() || keys->size() > kMaxPathKeys)
        throw InputError(file, place + "/keys", fmt::format("is no list of 1 to {} keys", kMaxPathKeys));
    for (size_t i = 0; i < keys->size(); ++i) {
        const std::string at = fmt::format("{}/keys/{}", place, i);
        path.keys.push_back(key_of((*keys)[i], file, at));
        if (i > 0 && !(path.keys[i].time_s > path.keys[i - 1].time_s))
            throw InputError(file, at + "/time", "is not after the key before it");
    }
    members.choice("interpolation", kInterpolationNames, path.interpolation);
    members.boolean("cyclic", path.cyclic);
    const double last_s = path.duration_s = path.keys.back().time_s;
    members.number("duration", 0, kMaxStageSeconds, path.duration_s);
    const bool returns = path.cyclic && path.keys.size() > 1;
    if (returns ? path.duration_s <= last_s : path.duration_s < last_s)
        throw InputError(file, place + "/duration",
                         fmt::format("is {} s, and its last key at {} s", path.duration_s, last_s),
                         returns ? "give a cycle time to come back to its first key" : "give the whole duration");
    return path;
}

ordered_json json_of(const CameraPathKey& key) {
    const glm::dvec3& p = key.position;
    const glm::dquat& q = key.world_from_camera;
    return {
        {"time", key.time_s}, {"position", {p.x, p.y, p.z}}, {"rotation", {q.x, q.y, q.z, q.w}}, {"yfov", key.angle_y}};
}

ordered_json json_of(const CameraPath& path) {
    ordered_json json = {{"keys", ordered_json::array()}};
    for (const CameraPathKey& key : path.keys) json["keys"].push_back(json_of(key));
    if (path.interpolation != Interpolation::kSmooth)
        json["interpolation"] = kInterpolationNames[static_cast<size_t>(path.interpolation)];
    if (path.cyclic) json["cyclic"] = true;
    json["duration"] = path.duration_s;
    return json;
}

}  // namespace neuvv::stage

#include "stage/stage_settings.h"

#include <cmath>

#include "base/error.h"
#include "base/formats/json.h"
#include "stage/camera_path_json.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

constexpr double kMaxColor = 1e6, kMaxIntensity = 1e6, kMaxRotation = 1e6;

ordered_json color_json(const glm::dvec3& color) {
    return {color.r, color.g, color.b};
}

// Reads three numbers from 0. A missing colour leaves `value` as it is.
void read_color(const JsonMembers& members, const char* name, glm::dvec3& value) {
    const ordered_json* found = members.find(name);
    if (!found) return;
    const bool whole = found->is_array() && found->size() == 3;
    for (int i = 0; i < 3; ++i) {
        const auto channel = static_cast<size_t>(i);
        const double given = whole && (*found)[channel].is_number() ? (*found)[channel].get<double>() : NAN;
        if (!(given >= 0 && given <= kMaxColor))
            members[name].fail("is not three numbers from 0, linear red, green and blue");
        value[i] = given;
    }
}

StageEnvironment environment_of(const ordered_json& json, const std::string& file, const std::string& place) {
    const JsonMembers members(json, file, place);
    StageEnvironment environment;
    members.text("uri", environment.uri);
    if (environment.uri.empty()) throw InputError(file, place, "names no file", "give it a \"uri\"");
    members.number("intensity", 0, kMaxIntensity, environment.intensity);
    members.number("rotation", -kMaxRotation, kMaxRotation, environment.rotation_deg);
    return environment;
}

}  // namespace

StageSettings stage_settings_of(const ordered_json& json, const std::string& file, const std::string& place) {
    const JsonMembers members(json, file, place);
    StageSettings settings;
    if (members.find("duration")) members.number("duration", 0, kMaxStageSeconds, settings.duration_s.emplace());
    if (members.find("fps")) members.number("fps", kMinStageFps, kMaxStageFps, settings.fps.emplace());
    read_color(members, "background", settings.background);
    if (const ordered_json* environment = members.find("environment"))
        settings.environment = environment_of(*environment, file, place + "/environment");
    if (members.find("ambient")) read_color(members, "ambient", settings.ambient.emplace());
    members.choice("blend", kStageBlendNames, settings.blend);
    members.boolean("shadows", settings.shadows);
    members.boolean("falloff", settings.falloff);
    if (const ordered_json* path = members.find("cameraPath"))
        settings.camera_path = camera_path_of(*path, file, place + "/cameraPath");
    return settings;
}

ordered_json json_of(const StageSettings& settings) {
    ordered_json json = ordered_json::object();
    if (settings.duration_s) json["duration"] = *settings.duration_s;
    if (settings.fps) json["fps"] = *settings.fps;
    if (settings.background != glm::dvec3(0)) json["background"] = color_json(settings.background);
    if (settings.environment) {
        json["environment"] = {{"uri", settings.environment->uri}};
        if (settings.environment->intensity != 1) json["environment"]["intensity"] = settings.environment->intensity;
        if (settings.environment->rotation_deg != 0)
            json["environment"]["rotation"] = settings.environment->rotation_deg;
    }
    if (settings.ambient) json["ambient"] = color_json(*settings.ambient);
    if (settings.blend != StageBlend::kExact) json["blend"] = kStageBlendNames[static_cast<size_t>(settings.blend)];
    if (!settings.shadows) json["shadows"] = false;
    if (!settings.falloff) json["falloff"] = false;
    if (settings.camera_path) json["cameraPath"] = json_of(*settings.camera_path);
    return json;
}

}  // namespace neuvv::stage

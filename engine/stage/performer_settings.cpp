#include "stage/performer_settings.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/formats/json.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

std::string required_uri(const JsonMembers& members) {
    std::string uri;
    members.text("uri", uri);
    if (uri.empty()) throw InputError(members.file, members.place, "names no file", "give it a \"uri\"");
    return uri;
}

}  // namespace

PaintLayer paint_layer_of(const ordered_json& json, const std::string& file, const std::string& place) {
    const JsonMembers members(json, file, place);
    PaintLayer layer;
    layer.uri = required_uri(members);
    members.text("name", layer.name);
    members.boolean("visible", layer.visible);
    members.number("opacity", 0, 1, layer.opacity);
    members.choice("blend", kPaintBlendNames, layer.blend);
    return layer;
}

PerformerSettings performer_settings_of(const ordered_json& json, const std::string& file, const std::string& place) {
    const JsonMembers members(json, file, place);
    PerformerSettings settings;
    settings.uri = required_uri(members);
    if (const ordered_json* time = members.find("time")) settings.time = time_map_of(*time, file, place + "/time");
    members.number("spin", -kMaxSpin, kMaxSpin, settings.spin_deg_per_s);
    members.boolean("visible", settings.visible);
    members.number("opacity", 0, 1, settings.opacity);
    members.boolean("castsShadow", settings.casts_shadow);
    members.boolean("receivesShadow", settings.receives_shadow);
    if (const ordered_json* skeleton = members.find("skeleton"))
        settings.skeleton_uri = required_uri(JsonMembers(*skeleton, file, place + "/skeleton"));
    if (const ordered_json* sound = members.find("sound")) {
        const JsonMembers own(*sound, file, place + "/sound");
        settings.sound = PerformerSound{required_uri(own)};
        own.number("gain", kLeastGain_db, kMostGain_db, settings.sound->gain_db);
    }
    const ordered_json* paint = members.find("paint");
    if (!paint) return settings;
    if (!paint->is_array() || paint->size() > kMaxPaintLayers)
        throw InputError(file, place + "/paint", fmt::format("is not a list of at most {} layers", kMaxPaintLayers));
    for (size_t i = 0; i < paint->size(); ++i)
        settings.paint.push_back(paint_layer_of((*paint)[i], file, fmt::format("{}/paint/{}", place, i)));
    return settings;
}

ordered_json json_of(const PaintLayer& layer) {
    ordered_json json = {{"uri", layer.uri}};
    if (!layer.name.empty()) json["name"] = layer.name;
    if (!layer.visible) json["visible"] = false;
    if (layer.opacity != 1) json["opacity"] = layer.opacity;
    if (layer.blend != PaintBlend::kNormal) json["blend"] = kPaintBlendNames[static_cast<size_t>(layer.blend)];
    return json;
}

ordered_json json_of(const PerformerSound& sound) {
    ordered_json json = {{"uri", sound.uri}};
    if (sound.gain_db != 0) json["gain"] = sound.gain_db;
    return json;
}

ordered_json json_of(const PerformerSettings& settings) {
    ordered_json json = {{"uri", settings.uri}};
    if (!settings.time.empty()) json["time"] = json_of(settings.time);
    if (settings.spin_deg_per_s != 0) json["spin"] = settings.spin_deg_per_s;
    if (!settings.visible) json["visible"] = false;
    if (settings.opacity != 1) json["opacity"] = settings.opacity;
    if (!settings.casts_shadow) json["castsShadow"] = false;
    if (!settings.receives_shadow) json["receivesShadow"] = false;
    if (!settings.skeleton_uri.empty()) json["skeleton"] = {{"uri", settings.skeleton_uri}};
    if (settings.sound) json["sound"] = json_of(*settings.sound);
    if (settings.paint.empty()) return json;
    json["paint"] = ordered_json::array();
    for (const PaintLayer& layer : settings.paint) json["paint"].push_back(json_of(layer));
    return json;
}

}  // namespace neuvv::stage

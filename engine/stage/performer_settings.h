// The glTF extension NEUVV_performer, which makes a node play a volumetric video. Its schema is
// NEUVV_performer.schema.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "stage/time_map.h"

namespace neuvv::stage {

constexpr const char* kPerformerExtension = "NEUVV_performer";
constexpr size_t kMaxPaintLayers = 64;
constexpr double kMaxSpin = 1e6;  // degrees per second

// How a paint layer's target colour is blended with the colour below it (paint.glsl). kNormal: the target replaces the
// colour. kMultiply: the product of both. kTint: the colour as if lit by the target, as bright as before. kRecolour:
// hue and saturation of the target, as bright as before.
enum class PaintBlend { kNormal, kMultiply, kTint, kRecolour };
constexpr const char* kPaintBlendNames[] = {"normal", "multiply", "tint", "recolour"};

struct PaintLayer {
    std::string uri;   // of a .nvpaint, relative to the stage
    std::string name;  // may be empty
    bool visible = true;
    double opacity = 1;  // 0..1
    PaintBlend blend = PaintBlend::kNormal;
};

constexpr double kLeastGain_db = -60, kMostGain_db = 24;

struct PerformerSound {
    std::string uri;     // of a file with a sound (file_or_address_of_uri)
    double gain_db = 0;  // kLeastGain_db to kMostGain_db
};

struct PerformerSettings {
    std::string uri;            // of the clip (file_or_address_of_uri)
    TimeMap time;               // stage time to clip time
    double spin_deg_per_s = 0;  // about the performer's +Y, proportional to stage time
    bool visible = true;
    double opacity = 1;  // 0..1
    bool casts_shadow = true, receives_shadow = true;
    std::vector<PaintLayer> paint;        // the lowest layer first
    std::optional<PerformerSound> sound;  // begins with the clip, and follows its time map
    std::string skeleton_uri;  // of its motion, relative to the stage; empty: the file beside the .nvv, if any
};

// `place` is the extension's (or the layer's) location in the JSON, for error messages. Throws InputError where a known
// member is invalid; unknown members are ignored.
PerformerSettings performer_settings_of(const nlohmann::ordered_json& json, const std::string& file,
                                        const std::string& place);
PaintLayer paint_layer_of(const nlohmann::ordered_json& json, const std::string& file, const std::string& place);

// Writes the URI, and the members that differ from their defaults.
nlohmann::ordered_json json_of(const PerformerSettings& settings);
nlohmann::ordered_json json_of(const PaintLayer& layer);
nlohmann::ordered_json json_of(const PerformerSound& sound);

}  // namespace neuvv::stage

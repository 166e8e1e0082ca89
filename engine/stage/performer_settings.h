// NEUVV_performer: what puts a volumetric video on a node. Its schema is NEUVV_performer.schema.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "stage/time_map.h"

namespace neuvv::stage {

constexpr const char* kPerformerExtension = "NEUVV_performer";
constexpr size_t kMaxPaintLayers = 64;
constexpr double kMaxSpin = 1e6;  // degrees per second

// How a layer's colours go over what is below (paint.glsl): the target; its product with the colour; as if lit by the
// target, as bright as before; hue and saturation of the target, as bright as before.
enum class PaintBlend { kNormal, kMultiply, kTint, kRecolour };
constexpr const char* kPaintBlendNames[] = {"normal", "multiply", "tint", "recolour"};

struct PaintLayer {
    std::string uri;   // of a .nvpaint, relative
    std::string name;  // may be empty
    bool visible = true;
    double opacity = 1;  // 0..1
    PaintBlend blend = PaintBlend::kNormal;
};

struct PerformerSettings {
    std::string uri;            // of the .nvv, relative
    TimeMap time;               // stage time to clip time
    double spin_deg_per_s = 0;  // about its own +Y while stage time runs
    bool visible = true;
    double opacity = 1;  // 0..1
    bool casts_shadow = true, receives_shadow = true;
    std::vector<PaintLayer> paint;  // the lowest first
};

// `place` is the extension's JSON place. Throws InputError; members it does not know are nobody's business.
PerformerSettings performer_settings_of(const nlohmann::ordered_json& json, const std::string& file,
                                        const std::string& place);
PaintLayer paint_layer_of(const nlohmann::ordered_json& json, const std::string& file, const std::string& place);

// Members that are not at their defaults, and the uri.
nlohmann::ordered_json json_of(const PerformerSettings& settings);
nlohmann::ordered_json json_of(const PaintLayer& layer);

}  // namespace neuvv::stage

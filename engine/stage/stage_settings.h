// The glTF extension NEUVV_stage: settings of a stage as a whole, on its glTF scene. Its schema is
// NEUVV_stage.schema.json.
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "stage/camera_path.h"

namespace neuvv::stage {

constexpr const char* kStageExtension = "NEUVV_stage";
constexpr double kMaxStageSeconds = 86400, kMinStageFps = 0.01, kMaxStageFps = 1000;

// How performers that overlap are blended (errata 11): kExact marches them together in the order of depth, kPaper puts
// whole layers over each other.
enum class StageBlend { kExact, kPaper };
constexpr const char* kStageBlendNames[] = {"exact", "paper"};

struct StageEnvironment {
    std::string uri;  // of an equirectangular PNG, relative to the stage; its centre column lies at −Z
    double intensity = 1;
    double rotation_deg = 0;  // about +Y, counter-clockwise seen from above
};

struct StageSettings {
    std::optional<double> duration_s;  // default: until all performers, animations and the camera path end
    std::optional<double> fps;         // images per second; default: that of the first clip
    glm::dvec3 background{0};          // linear RGB where nothing is visible
    std::optional<StageEnvironment> environment;
    std::optional<glm::dvec3> ambient;  // linear RGB light on everything; default: 1 in a scene without lights, else 0
    StageBlend blend = StageBlend::kExact;
    bool shadows = true, falloff = true;
    std::optional<CameraPath> camera_path;  // in stage time
};

// `place` is the extension's location in the JSON, for error messages. Throws InputError where a member is invalid.
StageSettings stage_settings_of(const nlohmann::ordered_json& json, const std::string& file, const std::string& place);

// Writes the members that differ from their defaults.
nlohmann::ordered_json json_of(const StageSettings& settings);

}  // namespace neuvv::stage

// NEUVV_stage: what a stage says about itself as a whole, on the glTF scene. Its schema is NEUVV_stage.schema.json.
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "stage/camera_path.h"

namespace neuvv::stage {

constexpr const char* kStageExtension = "NEUVV_stage";
constexpr double kMaxStageSeconds = 86400, kMinStageFps = 0.01, kMaxStageFps = 1000;

enum class StageBlend { kExact, kPaper };  // errata 11: marched together, or layer over layer
constexpr const char* kStageBlendNames[] = {"exact", "paper"};

struct StageEnvironment {
    std::string uri;  // of an equirectangular PNG, relative; its middle column lies at −Z
    double intensity = 1;
    double rotation_deg = 0;  // about +Y, counter-clockwise seen from above
};

struct StageSettings {
    std::optional<double> duration_s;  // not given: until all performers, animations and the camera path end
    std::optional<double> fps;         // not given: that of the first clip
    glm::dvec3 background{0};          // linear RGB where nothing is seen
    std::optional<StageEnvironment> environment;
    std::optional<glm::dvec3> ambient;  // linear RGB on everything; not given: 1 in a scene without lights, else 0
    StageBlend blend = StageBlend::kExact;
    bool shadows = true, falloff = true;
    std::optional<CameraPath> camera_path;  // in stage time
};

// `place` is the extension's JSON place. Throws InputError.
StageSettings stage_settings_of(const nlohmann::ordered_json& json, const std::string& file, const std::string& place);

// Members that are not at their defaults.
nlohmann::ordered_json json_of(const StageSettings& settings);

}  // namespace neuvv::stage

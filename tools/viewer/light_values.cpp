#include "tools/viewer/light_values.h"

#include <algorithm>

namespace neuvv::viewer {

namespace {

using nlohmann::ordered_json;

constexpr const char* kLightsExtension = "KHR_lights_punctual";
constexpr double kHardest = 1e-3;

const ordered_json* extension_of(const ordered_json& owner) {
    const auto extensions = owner.find("extensions");
    if (extensions == owner.end() || !extensions->is_object()) return nullptr;
    const auto found = extensions->find(kLightsExtension);
    return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

}  // namespace

std::optional<LightValues> light_values(const stage::StageFile& file, uint32_t node) {
    const ordered_json* held = extension_of(file.json.at("nodes").at(node));
    const ordered_json* lights = extension_of(file.json);
    if (!held || !lights) return {};
    const ordered_json& light = lights->at("lights").at(held->at("light").get<size_t>());
    LightValues values;
    const std::string kind = light.value("type", "");
    for (size_t i = 0; i < std::size(kLightKindNames); i++)
        if (kind == kLightKindNames[i]) values.kind = static_cast<stage::GltfLightKind>(i);
    if (const auto color = light.find("color"); color != light.end())
        for (int i = 0; i < 3; i++) values.color[i] = color->at(static_cast<size_t>(i)).get<double>();
    values.intensity = light.value("intensity", values.intensity);
    values.range_m = light.value("range", values.range_m);
    if (const auto spot = light.find("spot"); spot != light.end() && spot->is_object()) {
        values.inner_cone_deg = glm::degrees(spot->value("innerConeAngle", 0.0));
        values.outer_cone_deg = glm::degrees(spot->value("outerConeAngle", glm::radians(values.outer_cone_deg)));
    }
    return values;
}

double usual_intensity(stage::GltfLightKind kind) {
    return kind == stage::GltfLightKind::kDirectional ? 3 : 60;
}

double softness_of(double inner_cone_deg, double outer_cone_deg) {
    const double softness = outer_cone_deg > 0 ? 1 - inner_cone_deg / outer_cone_deg : 0;
    return softness <= kHardest * 1.001 ? 0 : std::min(softness, 1.0);
}

double inner_cone_for(double softness, double outer_cone_deg) {
    return outer_cone_deg * (1 - std::clamp(softness, kHardest, 1.0));
}

}  // namespace neuvv::viewer

#include "edit/light_values.h"

#include <algorithm>

#include "edit/document.h"

namespace neuvv::edit {

namespace {

constexpr double kMinSoftness = 1e-3;

}  // namespace

std::optional<LightValues> light_on(const stage::StageFile& file, uint32_t node) {
    if (node >= node_count(file)) return std::nullopt;
    const ordered_json* reference = find_extension(node_of(file, node), kLightsExtension);
    const ordered_json* lights = find_extension(file.json, kLightsExtension);
    if (!reference || !lights) return std::nullopt;
    const ordered_json& light = lights->at("lights").at(reference->at("light").get<size_t>());
    LightValues values;
    const std::string kind = light.value("type", "");
    for (size_t i = 0; i < std::size(kLightKindNames); ++i)
        if (kind == kLightKindNames[i]) values.kind = static_cast<stage::GltfLightKind>(i);
    if (const ordered_json* color = find_member(light, "color"))
        for (int i = 0; i < 3; ++i) values.color[i] = color->at(static_cast<size_t>(i)).get<double>();
    values.intensity = light.value("intensity", values.intensity);
    values.range_m = light.value("range", values.range_m);
    if (const ordered_json* spot = find_member(light, "spot"); spot && spot->is_object()) {
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
    return softness <= kMinSoftness * 1.001 ? 0 : std::min(softness, 1.0);
}

double inner_cone_for(double softness, double outer_cone_deg) {
    return outer_cone_deg * (1 - std::clamp(softness, kMinSoftness, 1.0));
}

}  // namespace neuvv::edit

// The lights of a document in the units that people type.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::edit {

struct LightValues {
    stage::GltfLightKind kind = stage::GltfLightKind::kPoint;
    glm::dvec3 color{1};                             // linear RGB
    double intensity = 1;                            // candela; lux where directional
    double range_m = 0;                              // 0: endless
    double inner_cone_deg = 0, outer_cone_deg = 45;  // half angles of a spot
};
constexpr const char* kLightKindNames[] = {"directional", "point", "spot"};  // by GltfLightKind

// The light on a node; nullopt where it has none. read.h says what is expected of the document.
std::optional<LightValues> light_on(const stage::StageFile& file, uint32_t node);

// The intensity of a new light: lux for a directional light, candela for others. A lamp at a usual distance then lights
// a subject about as brightly as a directional light.
double usual_intensity(stage::GltfLightKind kind);

// The share of a spot's cone in which its light fades: 0 is a sharp edge, 1 means that only the centre has the full
// light.
double softness_of(double inner_cone_deg, double outer_cone_deg);
// The inner half angle, in degrees, for this softness. It is less than the outer one, as glTF requires, even where the
// softness is 0.
double inner_cone_for(double softness, double outer_cone_deg);

}  // namespace neuvv::edit

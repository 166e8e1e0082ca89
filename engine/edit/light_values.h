// Lights as a document has them, in the numbers that people type.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "stage/gltf_scene.h"
#include "stage/stage_file.h"

namespace neuvv::edit {

struct LightValues {
    stage::GltfLightKind kind = stage::GltfLightKind::kPoint;
    glm::dvec3 color{1};                             // linear RGB
    double intensity = 1;                            // candela; lux where directional
    double range_m = 0;                              // 0: without end
    double inner_cone_deg = 0, outer_cone_deg = 45;  // half angles of a spot
};
constexpr const char* kLightKindNames[] = {"directional", "point", "spot"};  // by GltfLightKind

// The light on a node, nothing where it has none. What is expected of the document: read.h.
std::optional<LightValues> light_on(const stage::StageFile& file, uint32_t node);

// Of a new light: lux of a sun, candela of others, about as bright as that from where one hangs lamps.
double usual_intensity(stage::GltfLightKind kind);

// How much of a spot's cone fades: 0, a sharp edge, to 1, where only its middle has all the light.
double softness_of(double inner_cone_deg, double outer_cone_deg);
// The inner half angle for it; below the outer one, as files want it, also where it is 0.
double inner_cone_for(double softness, double outer_cone_deg);

}  // namespace neuvv::edit

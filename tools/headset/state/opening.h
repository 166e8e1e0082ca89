// The opening of a camera or a spot: the whole vertical field of view, or the half angle of the cone that the spot
// shines into, in degrees. Other lights have none.
#pragma once

#include <optional>
#include <string>

#include "edit/operations.h"
#include "stage/evaluated_stage.h"

namespace neuvv::headset {

struct Opening {
    double degrees = 0, low = 0, high = 0;  // `low` and `high` are what hands can set
    const char* verb = "";                  // of what it opens to: "sees" or "shines"
};
// Of a node; nullopt where it has none. Where a node has a spot and a camera, it is that of the camera.
std::optional<Opening> opening_of(const stage::StageFile& file, uint32_t node);
std::optional<Opening> opening_of_camera(const stage::StageFile& file, uint32_t node);
std::optional<Opening> opening_of_spot(const stage::StageFile& file, uint32_t node);

// Edits a file: gives a node that has an opening another one. A spot keeps the softness of its edge.
std::string set_opening(stage::StageFile& file, uint32_t node, double degrees);
std::string set_cone(stage::StageFile& file, uint32_t node, double degrees);
// Shows it in the evaluated stage alone.
void show_opening(stage::EvaluatedStage& evaluated, const stage::StageFile& file, uint32_t node, double degrees);

}  // namespace neuvv::headset

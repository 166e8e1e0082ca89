// What the renderer's limits leave of a stage's lights.
#pragma once

#include <string>
#include <vector>

#include "stage/evaluated_stage.h"

namespace neuvv::tools {

// As a light is packed for a frame.
struct LightShare {
    bool shines = true, casts_shadow = false;
    std::string text;  // what the limits take away
};

// By time.lights.
std::vector<LightShare> shares_of(const stage::Stage& stage, const stage::EvaluatedStage& evaluated);

}  // namespace neuvv::tools

// Which lights of a stage shine and cast shadows, as the renderer takes only so many.
#pragma once

#include <string>
#include <vector>

#include "stage/evaluated_stage.h"

namespace neuvv::render {

struct LightStatus {
    bool shines = true, casts_shadow = false;
    std::string
        text;  // why it does not shine or cast its shadow, where the renderer's limits are the reason; else empty
};

// In the order of evaluated.lights.
std::vector<LightStatus> light_statuses(const stage::Stage& stage, const stage::EvaluatedStage& evaluated);

}  // namespace neuvv::render

#include "render/clips/light_status.h"

#include <fmt/format.h>

#include "render/clips/stage_renderer.h"

namespace neuvv::render {

std::vector<LightStatus> light_statuses(const stage::Stage& stage, const stage::EvaluatedStage& evaluated) {
    std::vector<SetLight> lights;
    for (const stage::EvaluatedLight& light : evaluated.lights) lights.push_back(set_light(light));
    const ShaderLights packed = pack_lights(lights, {}, {}, {}, stage::performers_box(stage, evaluated), std::nullopt);
    std::vector<LightStatus> statuses(lights.size());
    for (size_t i = 0; i < lights.size(); ++i) {
        LightStatus& status = statuses[i];
        status.shines = i < packed.count;
        const bool has_shadow_map = status.shines && packed.light[i].shadow != kNoShadow;
        status.casts_shadow = has_shadow_map && stage.settings.shadows;
        if (!status.shines)
            status.text = fmt::format("does not shine: only the first {} do", kMaxSetLights);
        else if (lights[i].casts_shadow && !has_shadow_map)
            status.text =
                fmt::format("casts no shadow: only the first {} spots and directional lights do", kMaxShadows);
    }
    return statuses;
}

}  // namespace neuvv::render

#include "tools/light_shares.h"

#include <fmt/format.h>

#include "render/stage_renderer.h"

namespace neuvv::tools {

std::vector<LightShare> shares_of(const stage::Stage& stage, const stage::EvaluatedStage& evaluated) {
    std::vector<render::SetLight> lights;
    for (const stage::EvaluatedLight& light : evaluated.lights) lights.push_back(render::set_light(light));
    const ShaderLights packed =
        render::pack_lights(lights, {}, {}, {}, stage::performers_box(stage, evaluated), std::nullopt);
    std::vector<LightShare> shares(lights.size());
    for (size_t i = 0; i < lights.size(); ++i) {
        LightShare& share = shares[i];
        share.shines = i < packed.count;
        const bool has_map = share.shines && packed.light[i].shadow != kNoShadow;
        share.casts_shadow = has_map && stage.settings.shadows;
        if (!share.shines)
            share.text = fmt::format("does not shine: only the first {} do", kMaxSetLights);
        else if (lights[i].casts_shadow && !has_map)
            share.text = fmt::format("casts no shadow: only the first {} spots and directional lights do", kMaxShadows);
    }
    return shares;
}

}  // namespace neuvv::tools

// What covers a whole view of a set: the environment behind the scene, or in place of both a floor that shows nothing
// but the shadows on it.
#pragma once

#include <memory>
#include <optional>

#include "gpu/graphics_pass.h"
#include "render/set/set_lighting.h"
#include "shared/set.h"

namespace neuvv::render {

// Owns the pipeline that draws the environment where the depth is infinite, and what it is bound to.
struct SetBackground {
    SetBackground(const gpu::Device& device, const SetEnvironment& environment, const SetLighting& lighting);

    gpu::GraphicsPass pass;
    gpu::TextureSet bound;
};
gpu::TextureSet bind_background(const gpu::GraphicsPass& pass, const SetEnvironment& environment,
                                const SetLighting& lighting);
// `world_from_clip`: the inverse of clip_from_world.
void draw_background(gpu::Commands& commands, const SetBackground& background, const glm::mat4& world_from_clip);

// Owns the floor's height and the pipeline that draws it, which is made when a floor is given for the first time.
class ShadowCatcher {
  public:
    // none: shadows are not caught. `lighting` must outlive it.
    void set_floor(const gpu::Device& device, const SetLighting& lighting, std::optional<double> floor_m);
    bool has_floor() const { return floor_m_.has_value(); }
    // Needs a floor (assert).
    void draw(gpu::Commands& commands, SetPush push) const;

  private:
    struct Pipeline {
        gpu::GraphicsPass pass;
        gpu::TextureSet bound;
    };
    std::unique_ptr<Pipeline> pipeline_;
    std::optional<double> floor_m_;  // world
};

}  // namespace neuvv::render

// The light on the set of a stage: its lights and environment, and the shadow maps.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gpu/commands.h"
#include "render/set/environment.h"
#include "render/set/set_lights.h"
#include "shared/set.h"

namespace neuvv::render {

// Owns the lights as they were given, and packed for shaders, which lights() always is; their buffer; and the maps of
// both kinds of shadows. The buffers are never replaced, so that passes stay bound to them.
class SetLighting {
  public:
    SetLighting(const gpu::Device& device, std::shared_ptr<const SetEnvironment> environment);
    SetLighting(const SetLighting&) = delete;
    SetLighting& operator=(const SetLighting&) = delete;

    void light(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows = {});
    void surround(std::shared_ptr<const SetEnvironment> environment);
    // The set's pose, shapes or surfaces have changed: its shadow maps are drawn again. `set`: the box around it.
    void change_set(const WorldBox& set);
    // Sets the box of the performers that cast shadows; none: no performer does. PerformerShadows calls it.
    void set_shadow_casters(const std::optional<WorldBox>& performers);

    // To be recorded first: brings the lights to lights_buffer.
    void record_lights(gpu::Commands& commands) const;
    // Draws the shadow maps of the set, and calls `draw_set` with what to push for each. Records nothing where neither
    // the set nor the lights with shadows have changed.
    void record_shadow_maps(gpu::Commands& commands, const std::function<void(const SetPush&)>& draw_set);

    // The first kMaxSetLights lights that light() was called with.
    std::span<const SetLight> given_lights() const { return given_lights_; }
    // The lights as shaders take them: light[i].shadow is the index of a light's map in both kinds of shadow maps.
    const ShaderLights& lights() const { return packed_; }
    const std::shared_ptr<const SetEnvironment>& environment() const { return environment_; }
    // Whether the environment is the background, too.
    bool shows_environment() const { return environment_->has_image && ambient_.show_environment; }

    gpu::Buffer lights_buffer;    // a uniform ShaderLights
    gpu::Buffer set_shadow_maps;  // r32f, kMaxShadows maps; shadow.glsl reads them
    // rg32f, kMaxShadows maps: alpha, metres from the light's camera; 0 until a pass writes it
    gpu::Buffer performer_shadows;

  private:
    void pack();
    void record_shadow_map(gpu::Commands& commands, const ShaderLight& light,
                           const std::function<void(const SetPush&)>& draw_set) const;

    gpu::DeviceImage shadow_depth_;
    std::shared_ptr<const SetEnvironment> environment_;
    std::vector<SetLight> given_lights_;
    SetAmbient ambient_;
    SetShadows shadows_;
    WorldBox set_{};
    std::optional<WorldBox> performers_;
    ShaderLights packed_{};
    bool shadows_outdated_ = true;
};

}  // namespace neuvv::render

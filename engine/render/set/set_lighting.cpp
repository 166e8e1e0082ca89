#include "render/set/set_lighting.h"

#include <algorithm>

#include "render/set/set_attachments.h"

namespace neuvv::render {

SetLighting::SetLighting(const gpu::Device& device, std::shared_ptr<const SetEnvironment> environment)
    : environment_(std::move(environment)) {
    constexpr uint64_t kSetMap = uint64_t{kSetShadowSide} * kSetShadowSide,
                       kPerformerMap = uint64_t{kPerformerShadowSide} * kPerformerShadowSide;
    lights_buffer = gpu::Buffer(device, "set lights", sizeof(ShaderLights), gpu::MemoryKind::kDevice);
    set_shadow_maps = gpu::Buffer(device, "set shadow maps", 4 * kMaxShadows * kSetMap, gpu::MemoryKind::kDevice,
                                  VK_FORMAT_R32_SFLOAT);
    performer_shadows = gpu::Buffer(device, "performer shadows", 8 * kMaxShadows * kPerformerMap,
                                    gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_SFLOAT);
    shadow_depth_ = gpu::DeviceImage(device, "set shadow depth",
                                     {kSetShadowSide, kSetShadowSide, VK_FORMAT_D32_SFLOAT,
                                      VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    gpu::run_once(device, "shadow maps", [&](gpu::Commands& commands) {
        for (const gpu::Buffer* nothing : {&set_shadow_maps, &performer_shadows}) gpu::fill(commands, *nothing, 0);
    });
    given_lights_.reserve(kMaxSetLights);
    pack();
}

void SetLighting::light(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows) {
    given_lights_.assign(lights.begin(), lights.begin() + std::min<ptrdiff_t>(std::ssize(lights), kMaxSetLights));
    ambient_ = ambient;
    shadows_ = shadows;
    pack();
}

void SetLighting::set_shadow_casters(const std::optional<WorldBox>& performers) {
    if (performers == performers_) return;
    performers_ = performers;
    pack();
}

// Packs the lights for shaders. Shadow maps are drawn again where the matrix of one has changed.
void SetLighting::pack() {
    const ShaderLights before = packed_;
    packed_ = pack_lights(given_lights_, ambient_, shadows_, environment_->irradiance, set_, performers_);
    if (!environment_->has_image) packed_.environment.x = 0;
    packed_.environment.y = environment_->last_level;
    for (uint32_t i = 0; i < packed_.count; ++i)
        if (packed_.light[i].shadow != kNoShadow)
            shadows_outdated_ |= i >= before.count || packed_.light[i].shadow != before.light[i].shadow ||
                                 packed_.light[i].clip_from_world != before.light[i].clip_from_world;
}

void SetLighting::surround(std::shared_ptr<const SetEnvironment> environment) {
    environment_ = std::move(environment);
    pack();
}

void SetLighting::change_set(const WorldBox& set) {
    set_ = set;
    shadows_outdated_ = true;
    pack();
}

void SetLighting::record_lights(gpu::Commands& commands) const {
    gpu::update(commands, lights_buffer, packed_);
    gpu::compute_barrier(commands);
}

void SetLighting::record_shadow_maps(gpu::Commands& commands, const std::function<void(const SetPush&)>& draw_set) {
    if (!shadows_outdated_) return;
    shadows_outdated_ = false;
    for (uint32_t i = 0; i < packed_.count; ++i)
        if (packed_.light[i].shadow != kNoShadow) record_shadow_map(commands, packed_.light[i], draw_set);
    gpu::compute_barrier(commands);
}

void SetLighting::record_shadow_map(gpu::Commands& commands, const ShaderLight& light,
                                    const std::function<void(const SetPush&)>& draw_set) const {
    const gpu::PassScope scope(commands, "set shadow");
    to_attachment(commands, shadow_depth_);
    constexpr VkRect2D kWhole{{0, 0}, {kSetShadowSide, kSetShadowSide}};
    begin_drawing(commands, {}, depth_attachment(shadow_depth_, false), kWhole);
    SetPush push{};
    push.clip_from_world = light.clip_from_world;
    draw_set(push);
    vkCmdEndRendering(commands.handle());
    store(commands, shadow_depth_, kWhole, set_shadow_maps, light.shadow);
}

}  // namespace neuvv::render

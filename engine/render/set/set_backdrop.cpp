#include "render/set/set_backdrop.h"

#include <cassert>
#include <span>
#include <utility>

#include "gpu/commands.h"
#include "render/set/set_targets.h"
#include "spirv/set_background.frag.h"
#include "spirv/set_background.vert.h"
#include "spirv/set_catcher.frag.h"
#include "spirv/set_catcher.vert.h"

namespace neuvv::render {

namespace {

gpu::GraphicsShape background_shape() {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_background_vert;
    shape.fragment_spirv = set_background_frag;
    shape.colours = {kSetColour, kSetMetres};
    shape.blend = false;
    shape.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;  // so that it fills where the depth is infinite
    return shape;
}

gpu::GraphicsShape catcher_shape(const gpu::Device& device) {
    gpu::GraphicsShape shape;
    shape.vertex_spirv = set_catcher_vert;
    shape.fragment_spirv = device.buffers().fitting(set_catcher_frag, set_catcher_frag_storage);
    shape.colours = {kSetColour, kSetMetres};
    shape.blend = false;
    return shape;
}

// Draws a triangle that covers the view.
void draw_over_view(gpu::Commands& commands, const gpu::GraphicsPass& pass, const gpu::TextureSet& bound,
                    const SetPush& push, VkBool32 writes_depth) {
    VkCommandBuffer to = commands.handle();
    const VkDescriptorSet set = bound.handle();
    vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.pipeline());
    vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.layout(), 0, 1, &set, 0, nullptr);
    vkCmdPushConstants(to, pass.layout(), gpu::kDrawStages, 0, pass.interface().push_bytes, &push);
    vkCmdSetCullMode(to, VK_CULL_MODE_NONE);
    vkCmdSetFrontFace(to, VK_FRONT_FACE_COUNTER_CLOCKWISE);
    vkCmdSetDepthWriteEnable(to, writes_depth);
    vkCmdDraw(to, 3, 1, 0, 0);
}

}  // namespace

SetBackground::SetBackground(const gpu::Device& device, const SetEnvironment& environment, const SetLighting& lighting)
    : pass(device, "set background", background_shape()), bound(bind_background(pass, environment, lighting)) {}

gpu::TextureSet bind_background(const gpu::GraphicsPass& pass, const SetEnvironment& environment,
                                const SetLighting& lighting) {
    const std::pair<const gpu::DeviceImage*, const gpu::Sampler*> texture{&environment.image, &environment.sampler};
    return {pass, std::span(&texture, 1), {{kSetLights, &lighting.lights_buffer}}};
}

void draw_background(gpu::Commands& commands, const SetBackground& background, const glm::mat4& world_from_clip) {
    SetPush push{};
    push.clip_from_world = world_from_clip;
    draw_over_view(commands, background.pass, background.bound, push, VK_FALSE);
}

void ShadowCatcher::set_floor(const gpu::Device& device, const SetLighting& lighting, std::optional<double> floor_m) {
    if (floor_m && !pipeline_) {
        std::unique_ptr<Pipeline> made(new Pipeline{{device, "set shadow catcher", catcher_shape(device)}, {}});
        made->bound = gpu::TextureSet(made->pass, {},
                                      {{kSetLights, &lighting.lights_buffer},
                                       {kSetShadowMaps, &lighting.set_shadow_maps},
                                       {kSetPerformerShadows, &lighting.performer_shadows}});
        pipeline_ = std::move(made);
    }
    floor_m_ = floor_m;
}

void ShadowCatcher::draw(gpu::Commands& commands, SetPush push) const {
    assert(floor_m_);
    push.eye.y = static_cast<float>(*floor_m_);
    draw_over_view(commands, pipeline_->pass, pipeline_->bound, push, VK_TRUE);
}

}  // namespace neuvv::render

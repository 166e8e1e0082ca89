// One pair of vertex and fragment shader that draws triangles with depth, MSAA and premultiplied blending, by dynamic
// rendering, and the textures and buffers that are bound to it. Its layout is read from the SPIR-V.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/image.h"
#include "gpu/pass_layout.h"

namespace neuvv::gpu {

struct GraphicsShape {
    std::span<const uint32_t> vertex_spirv;
    std::span<const uint32_t> fragment_spirv;
    std::vector<VkVertexInputBindingDescription> streams;
    std::vector<VkVertexInputAttributeDescription> attributes;
    std::vector<VkFormat> colours = {VK_FORMAT_R16G16B16A16_SFLOAT};  // by location; empty: only depth
    bool blend = true;                                                // premultiplied, over the target
    VkFormat depth = VK_FORMAT_D32_SFLOAT;                            // reversed: near 1, far 0
    VkCompareOp depth_compare = VK_COMPARE_OP_GREATER;                // which new depths are drawn
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

// Viewport, scissor, cull mode, front face and depth write are dynamic state.
class GraphicsPass {
  public:
    GraphicsPass(const Device& device, std::string name, const GraphicsShape& shape);
    ~GraphicsPass();
    GraphicsPass(const GraphicsPass&) = delete;
    GraphicsPass& operator=(const GraphicsPass&) = delete;

    const std::string& name() const { return name_; }
    // The bindings of both stages together. The stages share one block of push constants.
    const ShaderInterface& interface() const { return interface_; }
    VkPipeline pipeline() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_.pipeline(); }
    VkDescriptorSetLayout set_layout() const { return layout_.set(); }
    const Device& device() const { return device_; }

  private:
    GraphicsPass(const Device& device, std::string name) : device_(device), name_(std::move(name)) {}
    const Device& device_;
    std::string name_;
    ShaderInterface interface_;
    PassLayout layout_;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

constexpr VkShaderStageFlags kDrawStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

// The textures and buffers that a draw reads, bound once at set-up. They must outlive the set, which is move-only.
class TextureSet {
  public:
    TextureSet() = default;
    // `textures` are for all samplers of the pass, in ascending order of their bindings; `buffers` has one for each
    // other binding. Throws RuntimeFailure where one is missing.
    TextureSet(const GraphicsPass& pass, std::span<const std::pair<const DeviceImage*, const Sampler*>> textures,
               std::initializer_list<std::pair<uint32_t, const Buffer*>> buffers = {});

    VkDescriptorSet handle() const { return set_.handle(); }

  private:
    DescriptorSet set_;
};

}  // namespace neuvv::gpu

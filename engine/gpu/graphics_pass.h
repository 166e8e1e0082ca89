// One pair of vertex and fragment shader that draws triangles with depth, MSAA and premultiplied blending, by dynamic
// rendering; its layout is read from the SPIR-V.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gpu/compute_pass.h"
#include "gpu/image.h"

namespace neuvv {

struct GraphicsShape {
    std::span<const uint32_t> vertex_spirv;
    std::span<const uint32_t> fragment_spirv;
    std::vector<VkVertexInputBindingDescription> streams;
    std::vector<VkVertexInputAttributeDescription> attributes;
    VkFormat colour = VK_FORMAT_R16G16B16A16_SFLOAT;
    VkFormat depth = VK_FORMAT_D32_SFLOAT;  // reversed: near 1, far 0, greater wins
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

// Dynamic: viewport, scissor, cull mode, front face, depth write.
class GraphicsPass {
  public:
    GraphicsPass(const Device& device, std::string name, const GraphicsShape& shape);
    ~GraphicsPass();
    GraphicsPass(const GraphicsPass&) = delete;
    GraphicsPass& operator=(const GraphicsPass&) = delete;

    const std::string& name() const { return name_; }
    // Bindings of both stages together; they share one block of push constants.
    const ShaderInterface& interface() const { return interface_; }
    VkPipeline pipeline() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_; }
    VkDescriptorSetLayout set_layout() const { return set_layout_; }
    const Device& device() const { return device_; }

  private:
    const Device& device_;
    std::string name_;
    ShaderInterface interface_;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

constexpr VkShaderStageFlags kDrawStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

// The textures of one draw, all of the pass's bindings in ascending order; move-only. Images and samplers must outlive
// it.
class TextureSet {
  public:
    TextureSet() = default;
    TextureSet(const GraphicsPass& pass, std::span<const std::pair<const DeviceImage*, const Sampler*>> textures);
    ~TextureSet();
    TextureSet(TextureSet&& other) noexcept;
    TextureSet& operator=(TextureSet&& other) noexcept;

    VkDescriptorSet handle() const { return set_; }

  private:
    const Device* device_ = nullptr;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace neuvv

// The parts that compute and graphics passes share: the layout of descriptors and push constants, which is read from
// the shaders' SPIR-V, the descriptor set, and the shader module. The device must outlive all of them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.h"

namespace neuvv::gpu {

struct BindingSlot {
    uint32_t binding = 0;
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
};

// The interface of a shader: its bindings of set 0 in ascending order, the bytes of its push constants, and the threads
// of a compute shader's workgroup.
struct ShaderInterface {
    std::vector<BindingSlot> bindings;
    uint32_t push_bytes = 0;
    uint32_t group_threads = 0;  // all along x; 0: not a compute shader
};
// Throws RuntimeFailure, which names the shader by `name`, for SPIR-V that cannot be read and for workgroups that have
// more than one dimension.
ShaderInterface reflect(std::span<const uint32_t> spirv, const std::string& name);

struct Buffer;
// Throws RuntimeFailure, which names pass, binding and buffer, where the buffer cannot be bound there.
void require_fits(const std::string& pass, const BindingSlot& slot, const Buffer& buffer);

// The layouts of a pass's descriptor set and pipeline. Move-only.
class PassLayout {
  public:
    PassLayout() = default;
    // Throws RuntimeFailure where the push constants are more bytes than the device allows.
    PassLayout(const Device& device, const ShaderInterface& interface, VkShaderStageFlags stages,
               const std::string& name);
    ~PassLayout();
    PassLayout(PassLayout&& other) noexcept;
    PassLayout& operator=(PassLayout&& other) noexcept;

    VkPipelineLayout pipeline() const { return pipeline_; }
    VkDescriptorSetLayout set() const { return set_; }

  private:
    const Device* device_ = nullptr;
    VkDescriptorSetLayout set_ = VK_NULL_HANDLE;
    VkPipelineLayout pipeline_ = VK_NULL_HANDLE;
};

// One descriptor set with a pool of its own. The caller writes its descriptors. Move-only.
class DescriptorSet {
  public:
    DescriptorSet() = default;
    DescriptorSet(const Device& device, const ShaderInterface& interface, VkDescriptorSetLayout layout,
                  const std::string& name);
    ~DescriptorSet();
    DescriptorSet(DescriptorSet&& other) noexcept;
    DescriptorSet& operator=(DescriptorSet&& other) noexcept;

    VkDescriptorSet handle() const { return set_; }

  private:
    const Device* device_ = nullptr;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

// Needed only until the pipeline is created.
class ShaderModule {
  public:
    ShaderModule(const Device& device, std::span<const uint32_t> spirv, const std::string& name);
    ~ShaderModule();
    ShaderModule(const ShaderModule&) = delete;
    ShaderModule& operator=(const ShaderModule&) = delete;

    VkShaderModule handle() const { return module_; }

  private:
    const Device& device_;
    VkShaderModule module_ = VK_NULL_HANDLE;
};

}  // namespace neuvv::gpu

// What a pass is bound by, read from its shaders' SPIR-V: the layout of its descriptors and push constants, the
// descriptors themselves, and a shader's module. Compute and graphics passes are made of these alike.
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

// What a shader's SPIR-V says of its interface: bindings of set 0 in ascending order, bytes of push constants, and of a
// compute shader the threads of a workgroup.
struct ShaderInterface {
    std::vector<BindingSlot> bindings;
    uint32_t push_bytes = 0;
    uint32_t group_threads = 0;  // all along x; 0: no compute shader
};
ShaderInterface reflect(std::span<const uint32_t> spirv, const std::string& name);

// Move-only. The device must outlive it, as everything below.
class PassLayout {
  public:
    PassLayout() = default;
    // Throws RuntimeFailure where the device takes fewer push constants.
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

// One descriptor set in a pool of its own, to be written by whoever made it. Move-only.
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

// Needed only until the pipeline is made.
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

// One compute shader, its layout read from its own SPIR-V, and the buffers it is bound to.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/pass_layout.h"

namespace neuvv::gpu {

// How many groups of so many hold `items`, the last of them perhaps in part.
constexpr uint32_t groups_of(uint64_t items, uint32_t group_size) {
    return static_cast<uint32_t>((items + group_size - 1) / group_size);
}

class ComputePass {
  public:
    // `constants` are specialisation constants by index (constant_id 0, 1, …). Compiles on creation, through the
    // device's pipeline cache, what its table of shaders has for `spirv`.
    ComputePass(const Device& device, std::string name, std::span<const uint32_t> spirv,
                const std::vector<uint32_t>& constants = {});
    ~ComputePass();
    ComputePass(const ComputePass&) = delete;
    ComputePass& operator=(const ComputePass&) = delete;

    const std::string& name() const { return name_; }
    const ShaderInterface& interface() const { return interface_; }
    VkPipeline pipeline() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_.pipeline(); }
    VkDescriptorSetLayout set_layout() const { return layout_.set(); }
    const Device& device() const { return device_; }

  private:
    ComputePass(const Device& device, std::string name) : device_(device), name_(std::move(name)) {}
    const Device& device_;
    std::string name_;
    ShaderInterface interface_;
    PassLayout layout_;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

using Bindings = std::vector<std::pair<uint32_t, const Buffer*>>;

inline Bindings joined(Bindings first, const Bindings& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

// The buffers of one pass, written once at set-up; nothing is written inside a frame. Every binding that the shader has
// must be given (RuntimeFailure) but that of the debug buffer (debug_buffer.h), of several for it the first counts,
// others are ignored; buffers must outlive the set.
class BindingSet {
  public:
    BindingSet() = default;
    BindingSet(const ComputePass& pass, const Bindings& buffers);

    VkDescriptorSet handle() const { return set_.handle(); }

  private:
    DescriptorSet set_;
};

}  // namespace neuvv::gpu

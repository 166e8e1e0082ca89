// One compute shader, whose layout is read from its SPIR-V, and the buffers that are bound to it.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/pass_layout.h"

namespace neuvv::gpu {

// How many groups of `group_size` are needed for `items`; the last group may be partly filled.
constexpr uint32_t groups_of(uint64_t items, uint32_t group_size) {
    return static_cast<uint32_t>((items + group_size - 1) / group_size);
}

class ComputePass {
  public:
    // Compiles the shader through the device's pipeline cache, or the replacement of `spirv` in the device's
    // ShaderTable. `constants` are the values of the specialisation constants with constant_id 0, 1, … Throws
    // RuntimeFailure where the shader needs more than the device's limits allow.
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

// The buffers of one pass. They are bound once at set-up, never inside a frame, and must outlive the set.
class BindingSet {
  public:
    BindingSet() = default;
    // `buffers` must name a buffer for every binding of the shader, except for that of the debug buffer
    // (debug_buffer.h), which is bound by itself. Of several buffers for a binding the first is used; bindings that the
    // shader does not have are ignored. Throws RuntimeFailure where a buffer is missing or does not fit the type of its
    // binding.
    BindingSet(const ComputePass& pass, const Bindings& buffers);

    VkDescriptorSet handle() const { return set_.handle(); }

  private:
    DescriptorSet set_;
};

}  // namespace neuvv::gpu

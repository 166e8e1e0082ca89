// One compute shader, whose layout is read from its SPIR-V, and the buffers that are bound to it.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/compute_program.h"
#include "gpu/pass_layout.h"

namespace neuvv::gpu {

// How many groups of `group_size` are needed for `items`; the last group may be partly filled.
constexpr uint32_t groups_of(uint64_t items, uint32_t group_size) {
    return static_cast<uint32_t>((items + group_size - 1) / group_size);
}

class ComputePass {
  public:
    // Takes the device's program of the shader, or of what replaces it in the device's ShaderTable (compute_program.h,
    // which says what it throws). `constants` are the values of the specialisation constants with constant_id 0, 1, …
    ComputePass(const Device& device, std::string name, std::span<const uint32_t> spirv,
                const std::vector<uint32_t>& constants = {})
        : device_(device), name_(std::move(name)), program_(device.programs().get(device, name_, spirv, constants)) {}
    ComputePass(const ComputePass&) = delete;
    ComputePass& operator=(const ComputePass&) = delete;

    const std::string& name() const { return name_; }
    const ShaderInterface& interface() const { return program_.interface(); }
    VkPipeline pipeline() const { return program_.pipeline(); }
    VkPipelineLayout layout() const { return program_.layout(); }
    VkDescriptorSetLayout set_layout() const { return program_.set_layout(); }
    const Device& device() const { return device_; }

  private:
    const Device& device_;
    std::string name_;
    const ComputeProgram& program_;
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

// A compute shader as the device runs it. A device keeps each that it has compiled, so that all passes of one shader
// and the same constants share it: a second renderer compiles nothing.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/pass_layout.h"

namespace neuvv::gpu {

class ComputeProgram {
  public:
    // Compiles the shader through the device's pipeline cache. `constants` are the values of the specialisation
    // constants with constant_id 0, 1, … Throws RuntimeFailure, which names the pass by `name`, where the shader needs
    // more than the device's limits allow.
    ComputeProgram(const Device& device, const std::string& name, std::span<const uint32_t> spirv,
                   const std::vector<uint32_t>& constants);
    ~ComputeProgram();
    ComputeProgram(const ComputeProgram&) = delete;
    ComputeProgram& operator=(const ComputeProgram&) = delete;

    const ShaderInterface& interface() const { return interface_; }
    VkPipeline pipeline() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_.pipeline(); }
    VkDescriptorSetLayout set_layout() const { return layout_.set(); }

  private:
    explicit ComputeProgram(const Device& device) : device_(device) {}
    const Device& device_;
    ShaderInterface interface_;
    PassLayout layout_;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

// The programs of one device. Any thread may use it, also while another one compiles.
class ComputePrograms {
  public:
    // The program of the newest version of `spirv` (shader_table.h) with these constants, compiled if it is not there
    // yet. It exists for as long as the device, also where its shader has been replaced since; its debug name is that
    // of the pass that compiled it.
    const ComputeProgram& get(const Device& device, const std::string& name, std::span<const uint32_t> spirv,
                              const std::vector<uint32_t>& constants);

    size_t count() const;

  private:
    using Key = std::pair<std::vector<uint32_t>, std::vector<uint32_t>>;  // SPIR-V and constants
    mutable std::mutex mutex_;
    std::map<Key, std::unique_ptr<ComputeProgram>> programs_;
};

}  // namespace neuvv::gpu

#include "gpu/compute_program.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "gpu/device.h"

namespace neuvv::gpu {

namespace {

VkPipeline make_pipeline(const Device& device, VkPipelineLayout layout, std::span<const uint32_t> spirv,
                         const std::vector<uint32_t>& constants, const std::string& name) {
    const ShaderModule module(device, spirv, name);
    std::vector<VkSpecializationMapEntry> entries;
    for (uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, i * 4, 4});
    const VkSpecializationInfo specialisation{static_cast<uint32_t>(entries.size()), entries.data(),
                                              constants.size() * 4, constants.data()};
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  nullptr,
                  0,
                  VK_SHADER_STAGE_COMPUTE_BIT,
                  module.handle(),
                  "main",
                  &specialisation};
    info.layout = layout;
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(vkCreateComputePipelines(device.handle(), device.pipeline_cache(), 1, &info, nullptr, &pipeline),
          "vkCreateComputePipelines", name);
    device.name_object(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline), name);
    return pipeline;
}

void require_bindings(const Device& device, const ShaderInterface& interface, const std::string& name) {
    const VkPhysicalDeviceLimits& limits = device.limits();
    const struct {
        VkDescriptorType type;
        uint32_t max;
        const char *what, *other;  // of NEUVV_BUFFERS, which may bind fewer of them
    } kinds[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, limits.maxPerStageDescriptorStorageBuffers, "storage buffers", "texel"},
        {VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, limits.maxPerStageDescriptorStorageImages, "storage texel buffers",
         "storage"},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, limits.maxPerStageDescriptorSampledImages, "texel buffers",
         "storage"}};
    for (const auto& kind : kinds) {
        const auto count = std::count_if(interface.bindings.begin(), interface.bindings.end(),
                                         [&](const BindingSlot& slot) { return slot.type == kind.type; });
        if (count > kind.max)
            throw RuntimeFailure(fmt::format("pass \"{}\" binds {} {}, device \"{}\" takes {}; try NEUVV_BUFFERS={}",
                                             name, count, kind.what, device.summary().name, kind.max, kind.other));
    }
}

}  // namespace

// Delegates, so that the destructor frees what was created when a later step throws.
ComputeProgram::ComputeProgram(const Device& device, const std::string& name, std::span<const uint32_t> spirv,
                               const std::vector<uint32_t>& constants)
    : ComputeProgram(device) {
    interface_ = reflect(spirv, name);
    require_bindings(device, interface_, name);
    if (interface_.group_threads > device.limits().maxComputeWorkGroupInvocations)
        throw RuntimeFailure(fmt::format("pass \"{}\": workgroups of {} threads, the device takes {}", name,
                                         interface_.group_threads, device.limits().maxComputeWorkGroupInvocations));
    layout_ = PassLayout(device, interface_, VK_SHADER_STAGE_COMPUTE_BIT, name);
    pipeline_ = make_pipeline(device, layout_.pipeline(), spirv, constants, name);
}

ComputeProgram::~ComputeProgram() {
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
}

const ComputeProgram& ComputePrograms::get(const Device& device, const std::string& name,
                                           std::span<const uint32_t> spirv, const std::vector<uint32_t>& constants) {
    Key key{device.shaders().newest(spirv), constants};
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = programs_.find(key); found != programs_.end()) return *found->second;
    }
    // Two threads may compile the same; the one that ends first is kept.
    auto program = std::make_unique<ComputeProgram>(device, name, key.first, constants);
    const std::lock_guard lock(mutex_);
    return *programs_.try_emplace(std::move(key), std::move(program)).first->second;
}

size_t ComputePrograms::count() const {
    const std::lock_guard lock(mutex_);
    return programs_.size();
}

}  // namespace neuvv::gpu

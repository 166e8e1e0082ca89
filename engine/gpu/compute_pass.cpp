#include "gpu/compute_pass.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "gpu/debug_buffer.h"

namespace neuvv::gpu {

namespace {

VkPipeline make_pipeline(const Device& device, VkPipelineLayout layout, std::span<const uint32_t> spirv,
                         const std::vector<uint32_t>& constants, const std::string& name) {
    const ShaderModule module(device, spirv, name);
    std::vector<VkSpecializationMapEntry> entries;
    for (uint32_t i = 0; i < constants.size(); i++) entries.push_back({i, i * 4, 4});
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
        const char* what;
    } kinds[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, limits.maxPerStageDescriptorStorageBuffers, "storage buffers"},
        {VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, limits.maxPerStageDescriptorStorageImages, "storage texel buffers"},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, limits.maxPerStageDescriptorSampledImages, "texel buffers"}};
    for (const auto& kind : kinds) {
        const auto count = std::count_if(interface.bindings.begin(), interface.bindings.end(),
                                         [&](const BindingSlot& slot) { return slot.type == kind.type; });
        if (count > kind.max)
            throw RuntimeFailure(fmt::format("pass \"{}\" binds {} {}, device \"{}\" takes {}", name, count, kind.what,
                                             device.summary().name, kind.max));
    }
}

}  // namespace

// Delegates, so that the destructor frees what was created when a later step throws.
ComputePass::ComputePass(const Device& device, std::string name, std::span<const uint32_t> spirv,
                         const std::vector<uint32_t>& constants)
    : ComputePass(device, std::move(name)) {
    const std::vector<uint32_t> newest = device.shaders().newest(spirv);
    interface_ = reflect(newest, name_);
    require_bindings(device, interface_, name_);
    if (interface_.group_threads > device.limits().maxComputeWorkGroupInvocations)
        throw RuntimeFailure(fmt::format("pass \"{}\": workgroups of {} threads, the device takes {}", name_,
                                         interface_.group_threads, device.limits().maxComputeWorkGroupInvocations));
    layout_ = PassLayout(device, interface_, VK_SHADER_STAGE_COMPUTE_BIT, name_);
    pipeline_ = make_pipeline(device, layout_.pipeline(), newest, constants, name_);
}

ComputePass::~ComputePass() {
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
}

namespace {

void require_fits(const ComputePass& pass, const BindingSlot& slot, const Buffer& buffer) {
    const VkPhysicalDeviceLimits& limits = pass.device().limits();
    const bool texel =
        slot.type == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER || slot.type == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
    if (texel && !buffer.view)
        throw RuntimeFailure(fmt::format("pass \"{}\", binding {}: buffer \"{}\" has no texel format", pass.name(),
                                         slot.binding, buffer.name));
    if (slot.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER && buffer.bytes > limits.maxStorageBufferRange)
        throw RuntimeFailure(fmt::format(
            "pass \"{}\": storage buffer \"{}\" is {} MiB, device \"{}\" binds at most {} MiB", pass.name(),
            buffer.name, buffer.bytes >> 20, pass.device().summary().name, limits.maxStorageBufferRange >> 20));
}

}  // namespace

BindingSet::BindingSet(const ComputePass& pass, const Bindings& buffers)
    : set_(pass.device(), pass.interface(), pass.set_layout(), pass.name()) {
    std::vector<VkDescriptorBufferInfo> infos(pass.interface().bindings.size());
    std::vector<VkWriteDescriptorSet> writes;
    for (size_t i = 0; i < infos.size(); i++) {
        const BindingSlot& slot = pass.interface().bindings[i];
        const auto found =
            std::find_if(buffers.begin(), buffers.end(), [&](auto& b) { return b.first == slot.binding; });
        const bool debug = slot.binding == kDebugBinding;
        if (!debug && (found == buffers.end() || !found->second->buffer))
            throw RuntimeFailure(fmt::format("pass \"{}\": no buffer for binding {}", pass.name(), slot.binding));
        const Buffer& buffer = debug ? pass.device().debug_buffer().buffer() : *found->second;
        require_fits(pass, slot, buffer);
        infos[i] = {buffer.buffer, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set_.handle();
        write.dstBinding = slot.binding;
        write.descriptorCount = 1;
        write.descriptorType = slot.type;
        write.pBufferInfo = &infos[i];
        write.pTexelBufferView = &buffer.view;
        writes.push_back(write);
    }
    vkUpdateDescriptorSets(pass.device().handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

}  // namespace neuvv::gpu

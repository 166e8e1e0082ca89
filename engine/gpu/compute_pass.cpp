#include "gpu/compute_pass.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "gpu/debug_buffer.h"

namespace neuvv::gpu {

namespace {

VkDescriptorSetLayout make_set_layout(const Device& device, const ShaderInterface& interface, const std::string& name) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const BindingSlot& slot : interface.bindings)
        bindings.push_back({slot.binding, slot.type, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    info.bindingCount = static_cast<uint32_t>(bindings.size());
    info.pBindings = bindings.data();
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    check(vkCreateDescriptorSetLayout(device.handle(), &info, nullptr, &layout), "vkCreateDescriptorSetLayout", name);
    return layout;
}

VkPipelineLayout make_pipeline_layout(const Device& device, VkDescriptorSetLayout set, uint32_t push_bytes,
                                      const std::string& name) {
    const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = 1;
    info.pSetLayouts = &set;
    info.pushConstantRangeCount = push_bytes > 0 ? 1 : 0;
    info.pPushConstantRanges = &range;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check(vkCreatePipelineLayout(device.handle(), &info, nullptr, &layout), "vkCreatePipelineLayout", name);
    return layout;
}

VkPipeline make_pipeline(const Device& device, VkPipelineLayout layout, std::span<const uint32_t> spirv,
                         const std::vector<uint32_t>& constants, const std::string& name) {
    VkShaderModuleCreateInfo module_info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    module_info.codeSize = spirv.size_bytes();
    module_info.pCode = spirv.data();
    VkShaderModule module = VK_NULL_HANDLE;
    check(vkCreateShaderModule(device.handle(), &module_info, nullptr, &module), "vkCreateShaderModule", name);

    std::vector<VkSpecializationMapEntry> entries;
    for (uint32_t i = 0; i < constants.size(); i++) entries.push_back({i, i * 4, 4});
    const VkSpecializationInfo specialisation{static_cast<uint32_t>(entries.size()), entries.data(),
                                              constants.size() * 4, constants.data()};
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  nullptr,
                  0,
                  VK_SHADER_STAGE_COMPUTE_BIT,
                  module,
                  "main",
                  &specialisation};
    info.layout = layout;
    VkPipeline pipeline = VK_NULL_HANDLE;
    const VkResult result =
        vkCreateComputePipelines(device.handle(), device.pipeline_cache(), 1, &info, nullptr, &pipeline);
    vkDestroyShaderModule(device.handle(), module, nullptr);
    check(result, "vkCreateComputePipelines", name);
    device.name_object(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline), name);
    return pipeline;
}

}  // namespace

namespace {

void require_bindings(const Device& device, const ShaderInterface& interface, const std::string& name) {
    const VkPhysicalDeviceLimits& limits = device.limits();
    const struct {
        VkDescriptorType type;
        uint32_t most;
        const char* what;
    } kinds[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, limits.maxPerStageDescriptorStorageBuffers, "storage buffers"},
        {VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, limits.maxPerStageDescriptorStorageImages, "storage texel buffers"},
        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, limits.maxPerStageDescriptorSampledImages, "texel buffers"}};
    for (const auto& kind : kinds) {
        const auto wanted = std::count_if(interface.bindings.begin(), interface.bindings.end(),
                                          [&](const BindingSlot& slot) { return slot.type == kind.type; });
        if (wanted > kind.most)
            throw RuntimeFailure(fmt::format("pass \"{}\" binds {} {}, device \"{}\" takes {}", name, wanted, kind.what,
                                             device.summary().name, kind.most));
    }
}

}  // namespace

// Delegates, so that the destructor frees what was made before something failed.
ComputePass::ComputePass(const Device& device, std::string name, std::span<const uint32_t> spirv,
                         const std::vector<uint32_t>& constants)
    : ComputePass(device, std::move(name)) {
    const std::vector<uint32_t> newest = device.shaders().newest(spirv);
    interface_ = reflect(newest, name_);
    if (interface_.push_bytes > device.limits().maxPushConstantsSize)
        throw RuntimeFailure(fmt::format("pass \"{}\": {} bytes of push constants, the device takes {}", name_,
                                         interface_.push_bytes, device.limits().maxPushConstantsSize));
    require_bindings(device, interface_, name_);
    set_layout_ = make_set_layout(device, interface_, name_);
    layout_ = make_pipeline_layout(device, set_layout_, interface_.push_bytes, name_);
    pipeline_ = make_pipeline(device, layout_, newest, constants, name_);
}

ComputePass::~ComputePass() {
    vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
}

namespace {

std::pair<VkDescriptorPool, VkDescriptorSet> allocate_set(const ComputePass& pass) {
    const Device& device = pass.device();
    std::vector<VkDescriptorPoolSize> sizes;
    for (const BindingSlot& slot : pass.interface().bindings) sizes.push_back({slot.type, 1});
    VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool_info.maxSets = 1;
    pool_info.poolSizeCount = static_cast<uint32_t>(sizes.size());
    pool_info.pPoolSizes = sizes.data();
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check(vkCreateDescriptorPool(device.handle(), &pool_info, nullptr, &pool), "vkCreateDescriptorPool", pass.name());
    const VkDescriptorSetLayout layout = pass.set_layout();
    VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool, 1, &layout};
    VkDescriptorSet set = VK_NULL_HANDLE;
    check(vkAllocateDescriptorSets(device.handle(), &info, &set), "vkAllocateDescriptorSets", pass.name());
    device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_SET, reinterpret_cast<uint64_t>(set), pass.name());
    return {pool, set};
}

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

// Delegates, so that the destructor frees the pool when a buffer does not fit.
BindingSet::BindingSet(const ComputePass& pass, const Bindings& buffers) : BindingSet() {
    device_ = &pass.device();
    std::tie(pool_, set_) = allocate_set(pass);
    std::vector<VkDescriptorBufferInfo> infos(pass.interface().bindings.size());
    std::vector<VkWriteDescriptorSet> writes;
    for (size_t i = 0; i < infos.size(); i++) {
        const BindingSlot& slot = pass.interface().bindings[i];
        const auto found =
            std::find_if(buffers.begin(), buffers.end(), [&](auto& b) { return b.first == slot.binding; });
        const bool debug = slot.binding == kDebugBinding;
        if (!debug && (found == buffers.end() || !found->second->buffer))
            throw RuntimeFailure(fmt::format("pass \"{}\": no buffer for binding {}", pass.name(), slot.binding));
        const Buffer& buffer = debug ? device_->debug_buffer().buffer() : *found->second;
        require_fits(pass, slot, buffer);
        infos[i] = {buffer.buffer, 0, VK_WHOLE_SIZE};
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set_;
        write.dstBinding = slot.binding;
        write.descriptorCount = 1;
        write.descriptorType = slot.type;
        write.pBufferInfo = &infos[i];
        write.pTexelBufferView = &buffer.view;
        writes.push_back(write);
    }
    vkUpdateDescriptorSets(device_->handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

BindingSet::~BindingSet() {
    if (device_) vkDestroyDescriptorPool(device_->handle(), pool_, nullptr);
}

BindingSet::BindingSet(BindingSet&& other) noexcept {
    *this = std::move(other);
}

BindingSet& BindingSet::operator=(BindingSet&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(pool_, other.pool_);
    std::swap(set_, other.set_);
    return *this;
}

}  // namespace neuvv::gpu

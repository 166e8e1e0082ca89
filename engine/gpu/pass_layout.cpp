#include "gpu/pass_layout.h"

#include <fmt/format.h>

#include <utility>

#include "base/error.h"
#include "gpu/buffer.h"

namespace neuvv::gpu {

namespace {

VkDescriptorSetLayout make_set_layout(const Device& device, const ShaderInterface& interface, VkShaderStageFlags stages,
                                      const std::string& name) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const BindingSlot& slot : interface.bindings)
        bindings.push_back({slot.binding, slot.type, 1, stages, nullptr});
    VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    info.bindingCount = static_cast<uint32_t>(bindings.size());
    info.pBindings = bindings.data();
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    check(vkCreateDescriptorSetLayout(device.handle(), &info, nullptr, &layout), "vkCreateDescriptorSetLayout", name);
    device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, reinterpret_cast<uint64_t>(layout), name);
    return layout;
}

VkPipelineLayout make_pipeline_layout(const Device& device, VkDescriptorSetLayout set, uint32_t push_bytes,
                                      VkShaderStageFlags stages, const std::string& name) {
    const VkPushConstantRange range{stages, 0, push_bytes};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = 1;
    info.pSetLayouts = &set;
    info.pushConstantRangeCount = push_bytes > 0 ? 1 : 0;
    info.pPushConstantRanges = &range;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check(vkCreatePipelineLayout(device.handle(), &info, nullptr, &layout), "vkCreatePipelineLayout", name);
    device.name_object(VK_OBJECT_TYPE_PIPELINE_LAYOUT, reinterpret_cast<uint64_t>(layout), name);
    return layout;
}

VkDescriptorPool make_pool(const Device& device, const ShaderInterface& interface, const std::string& name) {
    std::vector<VkDescriptorPoolSize> sizes;
    for (const BindingSlot& slot : interface.bindings) sizes.push_back({slot.type, 1});
    VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    info.maxSets = 1;
    info.poolSizeCount = static_cast<uint32_t>(sizes.size());
    info.pPoolSizes = sizes.data();
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check(vkCreateDescriptorPool(device.handle(), &info, nullptr, &pool), "vkCreateDescriptorPool", name);
    return pool;
}

}  // namespace

void require_fits(const std::string& pass, const BindingSlot& slot, const Buffer& buffer) {
    const BufferLimits& limits = buffer.device->buffers();
    const std::string& device = buffer.device->summary().name;
    const bool texel =
        slot.type == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER || slot.type == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
    if (texel && !buffer.view)
        throw RuntimeFailure(fmt::format("pass \"{}\", binding {}: buffer \"{}\" has no texel format, or in its {} MiB "
                                         "more texels than the {} that "
                                         "device \"{}\" binds",
                                         pass, slot.binding, buffer.name, buffer.bytes >> 20, limits.texels, device),
                             Remedy::kFewerLeaves);
    if (slot.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER && buffer.bytes > limits.storage_bytes)
        throw RuntimeFailure(
            fmt::format("pass \"{}\": storage buffer \"{}\" is {:.1f} MiB, device \"{}\" binds at most {} MiB, and "
                        "texel buffers of {} texels",
                        pass, buffer.name, static_cast<double>(buffer.bytes) / 1048576, device,
                        limits.storage_bytes >> 20, limits.texels),
            buffer.view ? Fix("NEUVV_BUFFERS=texel takes the latter") : Fix(Remedy::kSmallerImageOrOtherDevice));
}

// The constructors here and below delegate, so that the destructor frees what was created when a later step throws.
PassLayout::PassLayout(const Device& device, const ShaderInterface& interface, VkShaderStageFlags stages,
                       const std::string& name)
    : PassLayout() {
    device_ = &device;
    if (interface.push_bytes > device.limits().maxPushConstantsSize)
        throw RuntimeFailure(fmt::format("pass \"{}\": {} bytes of push constants, the device takes {}", name,
                                         interface.push_bytes, device.limits().maxPushConstantsSize));
    set_ = make_set_layout(device, interface, stages, name);
    pipeline_ = make_pipeline_layout(device, set_, interface.push_bytes, stages, name);
}

PassLayout::~PassLayout() {
    if (!device_) return;
    vkDestroyPipelineLayout(device_->handle(), pipeline_, nullptr);
    vkDestroyDescriptorSetLayout(device_->handle(), set_, nullptr);
}

PassLayout::PassLayout(PassLayout&& other) noexcept {
    *this = std::move(other);
}

PassLayout& PassLayout::operator=(PassLayout&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(set_, other.set_);
    std::swap(pipeline_, other.pipeline_);
    return *this;
}

DescriptorSet::DescriptorSet(const Device& device, const ShaderInterface& interface, VkDescriptorSetLayout layout,
                             const std::string& name)
    : DescriptorSet() {
    device_ = &device;
    pool_ = make_pool(device, interface, name);
    VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool_, 1, &layout};
    check(vkAllocateDescriptorSets(device.handle(), &info, &set_), "vkAllocateDescriptorSets", name);
    device.name_object(VK_OBJECT_TYPE_DESCRIPTOR_SET, reinterpret_cast<uint64_t>(set_), name);
}

DescriptorSet::~DescriptorSet() {
    if (device_) vkDestroyDescriptorPool(device_->handle(), pool_, nullptr);
}

DescriptorSet::DescriptorSet(DescriptorSet&& other) noexcept {
    *this = std::move(other);
}

DescriptorSet& DescriptorSet::operator=(DescriptorSet&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(pool_, other.pool_);
    std::swap(set_, other.set_);
    return *this;
}

ShaderModule::ShaderModule(const Device& device, std::span<const uint32_t> spirv, const std::string& name)
    : device_(device) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    check(vkCreateShaderModule(device.handle(), &info, nullptr, &module_), "vkCreateShaderModule", name);
}

ShaderModule::~ShaderModule() {
    vkDestroyShaderModule(device_.handle(), module_, nullptr);
}

}  // namespace neuvv::gpu

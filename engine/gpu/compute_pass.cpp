#include "gpu/compute_pass.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "gpu/debug_buffer.h"

namespace neuvv::gpu {

BindingSet::BindingSet(const ComputePass& pass, const Bindings& buffers)
    : set_(pass.device(), pass.interface(), pass.set_layout(), pass.name()) {
    std::vector<VkDescriptorBufferInfo> infos(pass.interface().bindings.size());
    std::vector<VkWriteDescriptorSet> writes;
    for (size_t i = 0; i < infos.size(); ++i) {
        const BindingSlot& slot = pass.interface().bindings[i];
        const auto found =
            std::find_if(buffers.begin(), buffers.end(), [&](auto& b) { return b.first == slot.binding; });
        const bool debug = slot.binding == kDebugBinding;
        if (!debug && (found == buffers.end() || !found->second->buffer))
            throw RuntimeFailure(fmt::format("pass \"{}\": no buffer for binding {}", pass.name(), slot.binding));
        const Buffer& buffer = debug ? pass.device().debug_buffer().buffer() : *found->second;
        require_fits(pass.name(), slot, buffer);
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

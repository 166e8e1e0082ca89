#include "gpu/transfer_queue.h"

#include <vector>

#include "gpu/device.h"

namespace neuvv::gpu {

std::optional<uint32_t> TransferQueue::family_of(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    // Engines for videos can often copy, too, but are not made for it.
    constexpr VkQueueFlags kAllowed = VK_QUEUE_TRANSFER_BIT | VK_QUEUE_SPARSE_BINDING_BIT | VK_QUEUE_PROTECTED_BIT;
    for (uint32_t i = 0; i < count; ++i)
        if ((families[i].queueFlags & VK_QUEUE_TRANSFER_BIT) && (families[i].queueFlags & ~kAllowed) == 0 &&
            families[i].queueCount > 0)
            return i;
    return std::nullopt;
}

TransferQueue::TransferQueue(VkDevice device, uint32_t family) : device_(device), family_(family) {
    vkGetDeviceQueue(device, family, 0, &queue_);
    VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type, 0};
    check(vkCreateSemaphore(device, &info, nullptr, &semaphore_), "vkCreateSemaphore", "transfer queue");
}

TransferQueue::~TransferQueue() {
    vkDestroySemaphore(device_, semaphore_, nullptr);
}

uint64_t TransferQueue::submit(const VkCommandBufferSubmitInfo& commands, VkFence fence, const std::string& name) {
    const std::lock_guard lock(mutex_);
    const VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, semaphore_, submitted_ + 1,
                                       VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,    0};
    VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &commands;
    info.signalSemaphoreInfoCount = 1;
    info.pSignalSemaphoreInfos = &signal;
    check(vkQueueSubmit2(queue_, 1, &info, fence), "vkQueueSubmit2", name);
    return ++submitted_;
}

void TransferQueue::set_finished(uint64_t number) {
    uint64_t before = finished_;
    while (before < number && !finished_.compare_exchange_weak(before, number)) {
    }
}

std::optional<VkSemaphoreSubmitInfo> TransferQueue::unseen() const {
    const uint64_t finished = finished_;
    if (finished == seen_by_main_) return std::nullopt;
    return VkSemaphoreSubmitInfo{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, nullptr, semaphore_, finished,
                                 VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,    0};
}

}  // namespace neuvv::gpu

#include "gpu/memory_pool.h"

#include <algorithm>
#include <bit>

namespace neuvv::gpu {

namespace {

constexpr VkDeviceSize kMostKept = VkDeviceSize{64} << 20;  // of all memory together
constexpr size_t kMostPieces = 256;  // a driver may have no more than 4096 at a time, with those in use
constexpr VkDeviceSize kLargestKept = VkDeviceSize{32} << 20;  // of one piece

// Sizes are rounded up by an eighth at most, small ones to 256 bytes, so that memory fits buffers of about the same
// size.
VkDeviceSize rounded(VkDeviceSize bytes) {
    if (bytes > kLargestKept) return bytes;
    const VkDeviceSize step = std::max<VkDeviceSize>(std::bit_floor(bytes) / 8, 256);
    return (bytes + step - 1) / step * step;
}

}  // namespace

bool MemoryPool::find(VkDeviceSize bytes, uint32_t type, bool mapped, DeviceMemory& memory) {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(kept_.rbegin(), kept_.rend(), [&](const DeviceMemory& one) {
        return one.bytes == bytes && one.type == type && (one.mapped != nullptr) == mapped;
    });
    if (found == kept_.rend()) return false;
    memory = *found;
    kept_bytes_ -= found->bytes;
    kept_.erase(std::next(found).base());
    return true;
}

VkResult MemoryPool::take(VkDevice device, VkDeviceSize bytes, uint32_t type, bool mapped, DeviceMemory& memory) {
    bytes = rounded(bytes);
    if (find(bytes, type, mapped, memory)) return VK_SUCCESS;
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.allocationSize = bytes;
    info.memoryTypeIndex = type;
    DeviceMemory made{VK_NULL_HANDLE, bytes, type};
    VkResult result = vkAllocateMemory(device, &info, nullptr, &made.memory);
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY) {
        clear(device);
        result = vkAllocateMemory(device, &info, nullptr, &made.memory);
    }
    if (result == VK_SUCCESS && mapped) {
        result = vkMapMemory(device, made.memory, 0, VK_WHOLE_SIZE, 0, &made.mapped);
        if (result != VK_SUCCESS) vkFreeMemory(device, made.memory, nullptr);
    }
    if (result == VK_SUCCESS) memory = made;
    return result;
}

void MemoryPool::give(VkDevice device, const DeviceMemory& memory) {
    if (!memory.memory) return;
    if (memory.bytes > kLargestKept) return vkFreeMemory(device, memory.memory, nullptr);
    const std::lock_guard lock(mutex_);
    kept_.push_back(memory);
    kept_bytes_ += memory.bytes;
    while (kept_bytes_ > kMostKept || kept_.size() > kMostPieces) {
        vkFreeMemory(device, kept_.front().memory, nullptr);
        kept_bytes_ -= kept_.front().bytes;
        kept_.pop_front();
    }
}

void MemoryPool::clear(VkDevice device) {
    const std::lock_guard lock(mutex_);
    for (const DeviceMemory& memory : kept_) vkFreeMemory(device, memory.memory, nullptr);
    kept_.clear();
    kept_bytes_ = 0;
}

}  // namespace neuvv::gpu

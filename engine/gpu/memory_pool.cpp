#include "gpu/memory_pool.h"

#include <algorithm>
#include <bit>

#include "gpu/result_name.h"

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

// Of its size and type.
VkResult MemoryPool::allocate(VkDevice device, DeviceMemory& memory) {
    const VkDeviceSize counted = counts(memory.type) ? memory.bytes : 0;
    {
        const std::lock_guard lock(mutex_);
        if (counted > 0 && limit_ && allocated_ + counted > *limit_) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        allocated_ += counted;
    }
    VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
    flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.pNext = addresses_ ? &flags : nullptr;
    info.allocationSize = memory.bytes;
    info.memoryTypeIndex = memory.type;
    const VkResult result = vkAllocateMemory(device, &info, nullptr, &memory.memory);
    if (result == VK_SUCCESS) return result;
    const std::lock_guard lock(mutex_);
    allocated_ -= counted;
    return result;
}

// Not under the lock: a driver may take long, and other threads take memory meanwhile.
void MemoryPool::free(VkDevice device, const std::deque<DeviceMemory>& memory) {
    for (const DeviceMemory& one : memory) vkFreeMemory(device, one.memory, nullptr);
    const std::lock_guard lock(mutex_);
    for (const DeviceMemory& one : memory)
        if (counts(one.type)) allocated_ -= one.bytes;
}

VkResult MemoryPool::take(VkDevice device, VkDeviceSize bytes, uint32_t type, bool mapped, DeviceMemory& memory) {
    bytes = rounded(bytes);
    if (find(bytes, type, mapped, memory)) return VK_SUCCESS;
    DeviceMemory made{VK_NULL_HANDLE, bytes, type};
    VkResult result = allocate(device, made);
    if (is_out_of_memory(result)) {
        clear(device);
        result = allocate(device, made);
    }
    if (result == VK_SUCCESS && mapped) {
        result = vkMapMemory(device, made.memory, 0, VK_WHOLE_SIZE, 0, &made.mapped);
        if (result != VK_SUCCESS) free(device, {made});
    }
    if (result == VK_SUCCESS) memory = made;
    return result;
}

void MemoryPool::give(VkDevice device, const DeviceMemory& memory) {
    if (!memory.memory) return;
    if (memory.bytes > kLargestKept) return free(device, {memory});
    std::deque<DeviceMemory> too_many;
    {
        const std::lock_guard lock(mutex_);
        kept_.push_back(memory);
        kept_bytes_ += memory.bytes;
        while (kept_bytes_ > kMostKept || kept_.size() > kMostPieces) {
            kept_bytes_ -= kept_.front().bytes;
            too_many.push_back(kept_.front());
            kept_.pop_front();
        }
    }
    if (!too_many.empty()) free(device, too_many);
}

void MemoryPool::clear(VkDevice device) {
    std::deque<DeviceMemory> all;
    {
        const std::lock_guard lock(mutex_);
        all.swap(kept_);
        kept_bytes_ = 0;
    }
    free(device, all);
}

void MemoryPool::set_limit(uint32_t types, std::optional<VkDeviceSize> limit) {
    const std::lock_guard lock(mutex_);
    counted_types_ = types;
    limit_ = limit;
}

std::optional<VkDeviceSize> MemoryPool::limit() const {
    const std::lock_guard lock(mutex_);
    return limit_;
}

VkDeviceSize MemoryPool::allocated() const {
    const std::lock_guard lock(mutex_);
    return allocated_;
}

}  // namespace neuvv::gpu

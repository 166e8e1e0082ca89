// Device memory of buffers and images: what those that are gone had is kept for others to come, because a driver may
// take long to allocate and to free memory, and whoever plays a stream needs some dozens of buffers for each frame.
#pragma once

#include <volk.h>

#include <deque>
#include <mutex>
#include <optional>

namespace neuvv::gpu {

struct DeviceMemory {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize bytes = 0;
    uint32_t type = 0;
    void* mapped = nullptr;  // where it was mapped, it stays so
};

// All functions may be called from any thread.
class MemoryPool {
  public:
    // Memory of a type that is at least so large, and mapped where that is asked for. Its contents are undefined.
    // Returns what vkAllocateMemory or vkMapMemory does where that fails.
    VkResult take(VkDevice device, VkDeviceSize bytes, uint32_t type, bool mapped, DeviceMemory& memory);
    // Gives back memory that the device uses no more.
    void give(VkDevice device, const DeviceMemory& memory);
    // Frees all that is kept.
    void clear(VkDevice device);

    // Says whether shaders may read buffers in the memory by their addresses. To be called before the first take().
    void set_addresses(bool addresses) { addresses_ = addresses; }

    // Memory of these types (a bit mask) counts as allocated(). Beyond the limit, take() returns
    // VK_ERROR_OUT_OF_DEVICE_MEMORY.
    void set_limit(uint32_t types, std::optional<VkDeviceSize> limit);
    std::optional<VkDeviceSize> limit() const;
    // Bytes, with what is kept.
    VkDeviceSize allocated() const;

  private:
    bool find(VkDeviceSize bytes, uint32_t type, bool mapped, DeviceMemory& memory);
    VkResult allocate(VkDevice device, DeviceMemory& memory);
    void free(VkDevice device, const std::deque<DeviceMemory>& memory);
    bool counts(uint32_t type) const { return counted_types_ >> type & 1; }
    bool addresses_ = false;
    mutable std::mutex mutex_;
    std::deque<DeviceMemory> kept_;  // the oldest first
    VkDeviceSize kept_bytes_ = 0;
    uint32_t counted_types_ = 0;
    std::optional<VkDeviceSize> limit_;
    VkDeviceSize allocated_ = 0;
};

}  // namespace neuvv::gpu

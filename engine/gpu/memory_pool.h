// Device memory of buffers that are gone, kept for buffers to come: a driver may take long to allocate and to free
// memory, and whoever plays a stream needs some dozens of buffers for each frame.
#pragma once

#include <volk.h>

#include <deque>
#include <mutex>

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

  private:
    bool find(VkDeviceSize bytes, uint32_t type, bool mapped, DeviceMemory& memory);
    std::mutex mutex_;
    std::deque<DeviceMemory> kept_;  // the oldest first
    VkDeviceSize kept_bytes_ = 0;
};

}  // namespace neuvv::gpu

// The memory of a device: its largest device-local heap, where all but staging buffers lie.
#pragma once

#include <volk.h>

#include <cstdint>
#include <optional>

namespace neuvv::gpu {

struct HeapMemory {
    uint64_t size = 0;               // bytes, as the others
    std::optional<uint64_t> budget;  // what this process may take of it now; nothing: the device does not tell
    uint64_t used = 0;               // what this process has taken of it
    uint32_t types = 0;              // bit mask of the memory types that lie in it
};

// Budget and usage are those of VK_EXT_memory_budget; without that extension there is no budget, and `used` is 0.
HeapMemory heap_memory(VkPhysicalDevice physical);

// The limit that NEUVV_DEVICE_MEMORY of the environment sets to what a process may take, in bytes (the variable has
// MiB); nothing where it is not set. Throws InputError for what is not a number above 0.
std::optional<uint64_t> memory_limit_of_environment();

}  // namespace neuvv::gpu

#include "gpu/heap_memory.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "gpu/features.h"

namespace neuvv::gpu {

HeapMemory heap_memory(VkPhysicalDevice physical) {
    const bool tells = has_extension(physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
    VkPhysicalDeviceMemoryProperties2 properties{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2, tells ? &budget : nullptr, {}};
    vkGetPhysicalDeviceMemoryProperties2(physical, &properties);
    const VkPhysicalDeviceMemoryProperties& memory = properties.memoryProperties;

    HeapMemory heap;
    uint32_t largest = 0;
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
        if (!(memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)) continue;
        if (memory.memoryHeaps[i].size <= heap.size) continue;
        heap.size = memory.memoryHeaps[i].size;
        largest = i;
    }
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
        if (memory.memoryTypes[i].heapIndex == largest) heap.types |= 1u << i;
    if (!tells) return heap;
    heap.budget = budget.heapBudget[largest];
    heap.used = budget.heapUsage[largest];
    return heap;
}

std::optional<uint64_t> memory_limit_of_environment() {
    const char* given = std::getenv("NEUVV_DEVICE_MEMORY");
    if (!given || !*given) return std::nullopt;
    const std::string_view text(given);
    uint64_t mebibytes = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), mebibytes);
    if (error != std::errc{} || end != text.data() + text.size() || mebibytes == 0 || mebibytes >> 40)
        throw InputError("NEUVV_DEVICE_MEMORY", given, "is not a number of MiB", "set it to 2048, for instance");
    return mebibytes << 20;
}

}  // namespace neuvv::gpu

// Device buffers. Hot arrays are read through texel buffers (a view with a format), see engine/README.md for why.
#pragma once

#include <string>

#include "gpu/device.h"

namespace neuvv::gpu {

enum class MemoryKind {
    kDevice,    // device-local; also mapped where the device shares memory with the host
    kUpload,    // host writes, device reads: always mapped, coherent
    kReadback,  // device writes, host reads: always mapped, coherent, cached where there is such memory
};

// Move-only. Usable as storage, uniform, texel, indirect, vertex and index buffer, and as source and target of copies.
struct Buffer {
    Buffer() = default;
    // `texel_format` other than UNDEFINED makes the view for texel bindings. Contents are undefined. Throws
    // RuntimeFailure naming the buffer where a device limit or its memory is exceeded. `bytes` of 0 is rounded up to
    // one texel.
    Buffer(const Device& device, std::string name, uint64_t bytes, MemoryKind kind,
           VkFormat texel_format = VK_FORMAT_UNDEFINED);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    template <typename T>
    T* as() const {
        return static_cast<T*>(mapped);
    }

    const Device* device = nullptr;
    std::string name;
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkBufferView view = VK_NULL_HANDLE;
    uint64_t bytes = 0;
    void* mapped = nullptr;  // null where the host cannot see it
};

// Bytes of one texel of the formats used here.
uint32_t texel_bytes(VkFormat format);

}  // namespace neuvv::gpu

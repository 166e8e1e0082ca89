// Device buffers. Arrays that shaders read often are read through texel buffers, that is, through a view with a format;
// engine/README.md says why.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "gpu/device.h"
#include "gpu/memory_pool.h"

namespace neuvv::gpu {

enum class MemoryKind {
    kDevice,    // device-local, not mapped
    kShared,    // as kDevice, but mapped and coherent where the host sees that memory, as that of software devices
    kUpload,    // the host writes, the device reads: always mapped and coherent
    kReadback,  // the device writes, the host reads: always mapped and coherent, and cached where the device offers it
};

// Move-only. Usable as storage, uniform, texel, indirect, vertex and index buffer, and as source and target of copies.
// The device must outlive it.
struct Buffer {
    Buffer() = default;
    // A `texel_format` other than UNDEFINED also creates the view for texel bindings, unless the buffer has more texels
    // than the device binds and passes bind it as a storage buffer (buffer_profile.h). The contents are undefined.
    // `bytes` below 16 are rounded up to 16. Throws RuntimeFailure, which names the buffer, where a limit of the device
    // or its memory is exceeded.
    Buffer(const Device& device, std::string name, uint64_t bytes, MemoryKind kind,
           VkFormat texel_format = VK_FORMAT_UNDEFINED);
    ~Buffer();
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;

    template <typename T>
    T* as() const {
        return static_cast<T*>(mapped);
    }

    // The address by which shaders can read the buffer without a binding: its low and its high word. The device must
    // have buffer_addresses() (assert).
    glm::uvec2 address() const;

    const Device* device = nullptr;
    std::string name;
    VkBuffer buffer = VK_NULL_HANDLE;
    DeviceMemory memory;
    VkBufferView view = VK_NULL_HANDLE;
    uint64_t bytes = 0;
    void* mapped = nullptr;  // null for kDevice, and for kShared where the host does not see it
};

// Bytes of one texel. Throws RuntimeFailure for a format that the program does not use in buffers.
uint32_t texel_bytes(VkFormat format);

}  // namespace neuvv::gpu

// How the passes of training bind long arrays (gpu/buffer_profile.h).
#pragma once

#include "gpu/device.h"

namespace neuvv::training {

// The storage buffers that a shader of training binds at most; a test counts them.
constexpr uint32_t kMostStorageBuffers = 14;

// The device's profile, or texel buffers where it does not bind as many storage buffers as training needs.
inline gpu::BufferLimits array_buffers(const gpu::Device& device) {
    gpu::BufferLimits limits = device.buffers();
    if (limits.storage_buffers < kMostStorageBuffers) limits.profile = gpu::BufferProfile::kTexel;
    return limits;
}

}  // namespace neuvv::training

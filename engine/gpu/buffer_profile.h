// How passes bind arrays that may have more than 65,536 elements: as texel buffers or as storage buffers. Vulkan
// guarantees no more elements of a texel buffer than that, and no more than 128 MiB of a storage buffer.
// shaders/arrays.glsl has both forms, and the build compiles the shaders of players and of training for each.
#pragma once

#include <volk.h>

#include <cstdint>
#include <optional>
#include <span>

namespace neuvv::gpu {

enum class BufferProfile { kTexel, kStorage };
enum class ProfileReason {
    kForced,  // by NEUVV_BUFFERS
    kLimits,  // its arrays may be longer
    kSpeed,   // arrays may be equally long, and it was faster (buffer_speed.h)
};

// What the same reads took in either profile.
struct ProfileTimes {
    double texel_ms = 0, storage_ms = 0;
};

// The storage buffers that a shader of a player binds at most in the storage profile; a test counts them. Training
// needs more (training/step/array_buffers.h).
constexpr uint32_t kMostStorageBuffers = 8;

// The limits of a device that decide, and the profile that its passes use.
struct BufferLimits {
    uint64_t texels = 0;           // of a texel buffer
    uint64_t storage_bytes = 0;    // of a storage buffer
    uint32_t storage_buffers = 0;  // of a shader stage
    bool addresses = true;         // whether shaders may read buffers by their addresses (features.h)
    BufferProfile profile = BufferProfile::kTexel;
    ProfileReason reason = ProfileReason::kLimits;
    std::optional<ProfileTimes> times;  // with kSpeed, once they are measured

    // Whether the shaders of a player can run in the storage profile.
    bool allow_storage() const { return addresses && storage_buffers >= kMostStorageBuffers; }
    // The elements that an array may have, each of `element_bytes`.
    uint64_t max_elements(uint32_t element_bytes) const {
        return profile == BufferProfile::kTexel ? texels : storage_bytes / element_bytes;
    }
    // The shader of the profile, of the two that the build has made of one source.
    std::span<const uint32_t> fitting(std::span<const uint32_t> texel, std::span<const uint32_t> storage) const {
        return profile == BufferProfile::kTexel ? texel : storage;
    }
};

// Takes the profile whose arrays may be longer. Where both hold 2 GiB or equally much, the reason is kSpeed and the
// profile texel buffers, until the two are timed. NEUVV_BUFFERS of the environment, "texel" or "storage", forces a
// profile; without `buffer_addresses`, it is texel buffers in any case. With "fastest" the two are timed, too, where
// one's arrays may be longer. They are timed only where the device can bind what is timed (2^20 texels) and allows
// storage buffers. Throws InputError for another value of NEUVV_BUFFERS.
BufferLimits buffer_limits(const VkPhysicalDeviceLimits& limits, bool buffer_addresses);

}  // namespace neuvv::gpu

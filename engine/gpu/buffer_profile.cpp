#include "gpu/buffer_profile.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "base/error.h"

namespace neuvv::gpu {

namespace {

constexpr uint64_t kWidestElement = 16;               // bytes: four floats, as the largest arrays have them
constexpr uint64_t kEnoughBytes = uint64_t{2} << 30;  // for every array of a player

BufferProfile longer(const BufferLimits& limits) {
    const uint64_t as_texels = std::min(kWidestElement * limits.texels, kEnoughBytes);
    const uint64_t as_storage = std::min(limits.storage_bytes, kEnoughBytes);
    return as_texels < as_storage && limits.storage_buffers >= kMostStorageBuffers ? BufferProfile::kStorage
                                                                                   : BufferProfile::kTexel;
}

}  // namespace

BufferLimits buffer_limits(const VkPhysicalDeviceLimits& limits) {
    BufferLimits result{limits.maxTexelBufferElements, limits.maxStorageBufferRange,
                        limits.maxPerStageDescriptorStorageBuffers};
    const char* environment = std::getenv("NEUVV_BUFFERS");
    const std::string forced = environment ? environment : "";
    if (!forced.empty() && forced != "texel" && forced != "storage")
        throw InputError("NEUVV_BUFFERS", forced, "is no profile", "give texel or storage, or leave it out");
    result.profile = forced.empty()      ? longer(result)
                     : forced == "texel" ? BufferProfile::kTexel
                                         : BufferProfile::kStorage;
    return result;
}

}  // namespace neuvv::gpu

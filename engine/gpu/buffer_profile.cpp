#include "gpu/buffer_profile.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "base/error.h"

namespace neuvv::gpu {

namespace {

constexpr uint64_t kWidestElement = 16;               // bytes: four floats, as the largest arrays have them
constexpr uint64_t kEnoughBytes = uint64_t{2} << 30;  // for every array of a player
constexpr uint64_t kTimedTexels = uint64_t{1} << 20;  // of the arrays by which profiles are timed (buffer_speed.cpp)

void choose_profile(BufferLimits& limits, const std::string& forced) {
    const uint64_t as_texels = std::min(kWidestElement * limits.texels, kEnoughBytes);
    const uint64_t as_storage = std::min(limits.storage_bytes, kEnoughBytes);
    const bool can_choose = limits.allow_storage();
    const bool can_time = can_choose && limits.texels >= kTimedTexels;
    if (!limits.addresses) return;  // texel buffers
    if (forced == "texel" || forced == "storage") {
        limits.profile = forced == "texel" ? BufferProfile::kTexel : BufferProfile::kStorage;
        limits.reason = ProfileReason::kForced;
    } else if (can_time && (as_texels == as_storage || forced == "fastest")) {
        limits.reason = ProfileReason::kSpeed;
    } else if (can_choose && as_texels < as_storage) {
        limits.profile = BufferProfile::kStorage;
    }
}

}  // namespace

BufferLimits buffer_limits(const VkPhysicalDeviceLimits& limits, bool buffer_addresses) {
    BufferLimits result{limits.maxTexelBufferElements, limits.maxStorageBufferRange,
                        limits.maxPerStageDescriptorStorageBuffers, buffer_addresses};
    const char* environment = std::getenv("NEUVV_BUFFERS");
    const std::string forced = environment ? environment : "";
    if (!forced.empty() && forced != "texel" && forced != "storage" && forced != "fastest")
        throw InputError("NEUVV_BUFFERS", forced, "is no profile", "give texel, storage or fastest, or leave it out");
    choose_profile(result, forced);
    return result;
}

}  // namespace neuvv::gpu

// How passes bind long arrays: the choice by a device's limits.
#include "gpu/buffer_profile.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

#include "support/input_error.h"

namespace neuvv::test {
namespace {

// NEUVV_BUFFERS with another value while it exists.
struct Forced {
    explicit Forced(const char* value) {
        if (const char* environment = std::getenv("NEUVV_BUFFERS")) before = environment;
        setenv("NEUVV_BUFFERS", value, 1);
    }
    ~Forced() { before ? setenv("NEUVV_BUFFERS", before->c_str(), 1) : unsetenv("NEUVV_BUFFERS"); }
    Forced(const Forced&) = delete;
    Forced& operator=(const Forced&) = delete;
    std::optional<std::string> before;
};

gpu::BufferLimits chosen(uint32_t texels, uint32_t storage_bytes, uint32_t storage_buffers, const char* forced = "") {
    const Forced environment(forced);
    VkPhysicalDeviceLimits limits{};
    limits.maxTexelBufferElements = texels;
    limits.maxStorageBufferRange = storage_bytes;
    limits.maxPerStageDescriptorStorageBuffers = storage_buffers;
    return gpu::buffer_limits(limits);
}

TEST(BufferProfile, IsThatOfTheLongerArrays) {
    using enum gpu::BufferProfile;
    const uint32_t mib = 1 << 20;
    EXPECT_EQ(chosen(65536, 128 * mib, 16).profile, kStorage) << "what Vulkan guarantees, and buffers enough";
    EXPECT_EQ(chosen(65536, 128 * mib, 4).profile, kTexel) << "shaders bind more storage buffers";
    EXPECT_EQ(chosen(128 * mib, 128 * mib, 32).profile, kTexel) << "lavapipe";
    EXPECT_EQ(chosen(128 * mib, 0xffffffffu, 1 << 20).profile, kTexel) << "2 GiB of either";
    EXPECT_EQ(chosen(16 * mib, 0xffffffffu, 1 << 20).profile, kStorage) << "256 MiB against 2 GiB";
    EXPECT_EQ(chosen(8 * mib, 128 * mib, 32).profile, kTexel) << "equally much";
}

TEST(BufferProfile, CanBeForced) {
    EXPECT_EQ(chosen(1 << 27, 1 << 27, 32, "storage").profile, gpu::BufferProfile::kStorage);
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "texel").profile, gpu::BufferProfile::kTexel);
    expect_input_error([] { chosen(1 << 27, 1 << 27, 32, "texels"); }, {"NEUVV_BUFFERS", "texels", "texel or storage"});
}

TEST(BufferProfile, BoundsTheElementsOfArrays) {
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "texel").max_elements(16), 65536u);
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "storage").max_elements(16), 1u << 23);
}

}  // namespace
}  // namespace neuvv::test

// How passes bind long arrays: the choice by a device's limits, and what shaders of each profile may use.
#include "gpu/buffer_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "gpu/pass_layout.h"
#include "spirv/neuvv_render_shaders.h"
#include "spirv/neuvv_training_shaders.h"
#include "spirv/neuvv_xr_shaders.h"
#include "support/environment_value.h"
#include "support/input_error.h"
#include "training/step/array_buffers.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kPortableStorageBuffers = 8;  // of a shader, as other graphics interfaces guarantee them

gpu::BufferLimits chosen(uint32_t texels, uint32_t storage_bytes, uint32_t storage_buffers, const char* forced = "",
                         bool addresses = true) {
    const EnvironmentValue environment("NEUVV_BUFFERS", forced);
    VkPhysicalDeviceLimits limits{};
    limits.maxTexelBufferElements = texels;
    limits.maxStorageBufferRange = storage_bytes;
    limits.maxPerStageDescriptorStorageBuffers = storage_buffers;
    return gpu::buffer_limits(limits, addresses);
}

TEST(BufferProfile, IsThatOfTheLongerArrays) {
    using enum gpu::BufferProfile;
    const uint32_t mib = 1 << 20;
    EXPECT_EQ(chosen(65536, 128 * mib, 16).profile, kStorage) << "what Vulkan guarantees, and buffers enough";
    EXPECT_EQ(chosen(65536, 128 * mib, 4).profile, kTexel) << "shaders bind more storage buffers";
    EXPECT_EQ(chosen(128 * mib, 128 * mib, 32).profile, kTexel) << "lavapipe";
    EXPECT_EQ(chosen(16 * mib, 0xffffffffu, 1 << 20).profile, kStorage) << "256 MiB against 2 GiB";
    EXPECT_EQ(chosen(128 * mib, 128 * mib, 32).reason, gpu::ProfileReason::kLimits);
}

TEST(BufferProfile, IsTheFasterWhereArraysMayBeEquallyLong) {
    using enum gpu::ProfileReason;
    const uint32_t mib = 1 << 20;
    EXPECT_EQ(chosen(128 * mib, 0xffffffffu, 1 << 20).reason, kSpeed) << "2 GiB of either";
    EXPECT_EQ(chosen(8 * mib, 128 * mib, 32).reason, kSpeed) << "equally much";
    EXPECT_EQ(chosen(8 * mib, 128 * mib, 32).profile, gpu::BufferProfile::kTexel) << "until it is known";
    EXPECT_EQ(chosen(128 * mib, 0xffffffffu, 4).reason, kLimits) << "shaders bind more storage buffers";
    EXPECT_EQ(chosen(128 * mib, 128 * mib, 32, "fastest").reason, kSpeed);
    EXPECT_EQ(chosen(65536, 1 * mib, 32).reason, kLimits) << "equally much, but too short to be timed";
    EXPECT_EQ(chosen(65536, 128 * mib, 32, "fastest").profile, gpu::BufferProfile::kStorage) << "too short to be timed";
}

TEST(BufferProfile, CanBeForced) {
    EXPECT_EQ(chosen(1 << 27, 1 << 27, 32, "storage").profile, gpu::BufferProfile::kStorage);
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "texel").profile, gpu::BufferProfile::kTexel);
    EXPECT_EQ(chosen(1 << 27, 0xffffffffu, 32, "storage").reason, gpu::ProfileReason::kForced) << "nothing is timed";
    expect_input_error([] { chosen(1 << 27, 1 << 27, 32, "texels"); },
                       {"NEUVV_BUFFERS", "texels", "texel, storage or fastest"});
}

TEST(BufferProfile, IsTexelWithoutAddressesOfBuffers) {
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "", false).profile, gpu::BufferProfile::kTexel);
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "storage", false).profile, gpu::BufferProfile::kTexel);
    EXPECT_EQ(chosen(1 << 27, 0xffffffffu, 32, "fastest", false).reason, gpu::ProfileReason::kLimits);
}

TEST(BufferProfile, BoundsTheElementsOfArrays) {
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "texel").max_elements(16), 65536u);
    EXPECT_EQ(chosen(65536, 1 << 27, 32, "storage").max_elements(16), 1u << 23);
}

// Whether a shader declares a capability of SPIR-V: OpCapability is operation 17, of two words.
bool has_capability(std::span<const uint32_t> spirv, uint32_t capability) {
    for (size_t at = 5; at < spirv.size() && spirv[at] >> 16 != 0; at += spirv[at] >> 16)
        if (spirv[at] == (2u << 16 | 17u) && spirv[at + 1] == capability) return true;
    return false;
}

constexpr uint32_t kInt64 = 11, kFloat64 = 10, kShader = 1;

uint32_t storage_buffers(std::span<const uint32_t> spirv, const char* file) {
    const gpu::ShaderInterface interface = gpu::reflect(spirv, file);
    return static_cast<uint32_t>(
        std::count_if(interface.bindings.begin(), interface.bindings.end(),
                      [](const auto& slot) { return slot.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER; }));
}

// Calls visit(file, SPIR-V, whether it is of the storage profile) for each shader that playing uses.
template <typename Visit>
void for_each_shader(const Visit& visit) {
    for (const auto& [file, words, storage] : neuvv_render_shaders) visit(file, words, storage);
    for (const auto& [file, words, storage] : neuvv_xr_shaders) visit(file, words, storage);
}

TEST(PlayersShaders, UseNoNumbersOf64Bits) {
    size_t shaders = 0;
    for_each_shader([&](const char* file, std::span<const uint32_t> words, bool) {
        EXPECT_TRUE(has_capability(words, kShader)) << file;  // so it is seen where it is there
        EXPECT_FALSE(has_capability(words, kInt64)) << file;
        EXPECT_FALSE(has_capability(words, kFloat64)) << file;
        ++shaders;
    });
    EXPECT_GT(shaders, 40u);
}

TEST(PlayersShaders, BindFewStorageBuffers) {
    uint32_t most = 0;
    for_each_shader([&](const char* file, std::span<const uint32_t> words, bool) {
        const uint32_t count = storage_buffers(words, file);
        most = std::max(most, count);
        EXPECT_LE(count, kPortableStorageBuffers) << file;
    });
    EXPECT_EQ(most, gpu::kMostStorageBuffers);
}

// The optimiser moves weights, moments and slice at once.
TEST(TrainingShaders, BindFewStorageBuffers) {
    uint32_t most = 0;
    for (const auto& [file, words, storage] : neuvv_training_shaders)
        most = std::max(most, storage_buffers(words, file));
    EXPECT_EQ(most, training::kMostStorageBuffers);
}

// Expects of each shader with two forms that these differ in how arrays are bound alone, and counts such shaders. Texel
// buffers that the storage profile keeps have few elements, whatever the clip.
struct PairsOfForms {
    std::map<std::string, gpu::ShaderInterface> texel;
    size_t pairs = 0;
    void add(const std::string& file, std::span<const uint32_t> words, bool storage) {
        if (!storage) {
            texel[file] = gpu::reflect(words, file);
            return;
        }
        const gpu::ShaderInterface& one = texel.at(file);
        const gpu::ShaderInterface other = gpu::reflect(words, file);
        ASSERT_EQ(one.bindings.size(), other.bindings.size()) << file;
        size_t changed = 0;
        for (size_t i = 0; i < one.bindings.size(); ++i) {
            EXPECT_EQ(one.bindings[i].binding, other.bindings[i].binding) << file;
            if (one.bindings[i].type == other.bindings[i].type) continue;
            EXPECT_EQ(other.bindings[i].type, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER) << file;
            ++changed;
        }
        EXPECT_GT(changed, 0u) << file << " needs no second form";
        EXPECT_EQ(one.push_bytes, other.push_bytes) << file;
        ++pairs;
    }
};

TEST(PlayersShaders, BindTheSameInBothProfiles) {
    PairsOfForms forms;
    for_each_shader([&](const std::string& file, std::span<const uint32_t> words, bool storage) {
        forms.add(file, words, storage);
    });
    EXPECT_GT(forms.pairs, 20u);
}

TEST(TrainingShaders, BindTheSameInBothProfiles) {
    PairsOfForms forms;
    for (const auto& [file, words, storage] : neuvv_training_shaders) forms.add(file, words, storage);
    EXPECT_EQ(forms.pairs, 18u);
}

}  // namespace
}  // namespace neuvv::test

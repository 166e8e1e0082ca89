// The memory of the device: what it has, what happens where there is none left; and a device that is lost.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <optional>
#include <utility>

#include "gpu/image.h"
#include "support/gpu_test.h"
#include "support/input_error.h"

namespace neuvv::test {
namespace {

constexpr uint64_t kMiB = uint64_t{1} << 20;

// Each test ends without a limit.
struct DeviceMemoryTest : GpuTest {
    DeviceMemoryTest() { device().memory_pool().clear(device().handle()); }
    ~DeviceMemoryTest() override { device().limit_memory(std::nullopt); }
    static void allow_more(uint64_t bytes) { device().limit_memory(device().memory_pool().allocated() + bytes); }
    static gpu::Buffer buffer(const char* name, uint64_t bytes) {
        return {device(), name, bytes, gpu::MemoryKind::kDevice};
    }
    // The error of a call that must lack memory.
    template <typename Call>
    static std::string lack(const Call& call) {
        try {
            call();
        } catch (const gpu::VulkanError& error) {
            EXPECT_TRUE(error.out_of_memory());
            return error.what();
        }
        ADD_FAILURE() << "there was memory";
        return "";
    }
};

TEST_F(DeviceMemoryTest, IsCountedAndLimited) {
    const gpu::HeapMemory all = device().memory();
    EXPECT_GT(all.size, 64 * kMiB);
    EXPECT_NE(all.types, 0u);
    const auto before = device().memory_pool().allocated();
    {
        const gpu::Buffer some = buffer("some", 40 * kMiB);
        EXPECT_EQ(device().memory_pool().allocated(), before + 40 * kMiB);
        const gpu::DeviceImage image(device(), "image",
                                     {1024, 1024, VK_FORMAT_R16G16B16A16_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT});
        EXPECT_GE(device().memory_pool().allocated(), before + 48 * kMiB) << "images count, too";
        allow_more(kMiB);
        const gpu::HeapMemory limited = device().memory();
        EXPECT_EQ(limited.size, device().memory_pool().allocated() + kMiB);
        EXPECT_EQ(limited.budget, limited.size);
        EXPECT_EQ(limited.used, device().memory_pool().allocated());
    }
    device().memory_pool().clear(device().handle());
    EXPECT_EQ(device().memory_pool().allocated(), before);
}

TEST_F(DeviceMemoryTest, ALackOfItNamesWhatWasAskedForAndWhatToDo) {
    allow_more(8 * kMiB);
    const std::string text = lack([] { buffer("entries", 40 * kMiB); });
    for (const std::string& part :
         {std::string("\"entries\", which needs 40.0 MiB"), device().summary().name, std::string("smaller image"),
          std::string("less memory for slices"), std::string("another device")})
        EXPECT_NE(text.find(part), std::string::npos) << part << " not in: " << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    const gpu::ImageShape large{4096, 4096, VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_USAGE_SAMPLED_BIT};
    EXPECT_NE(lack([&] { gpu::DeviceImage(device(), "target", large); }).find("\"target\""), std::string::npos);
    EXPECT_NE(buffer("a smaller one", 4 * kMiB).buffer, VkBuffer{VK_NULL_HANDLE}) << "the device stays usable";
}

TEST_F(DeviceMemoryTest, WhatThePoolKeepsIsGivenUpFirst) {
    buffer("short-lived", 20 * kMiB);
    allow_more(kMiB);
    EXPECT_NE(buffer("of another size", 18 * kMiB).buffer, VkBuffer{VK_NULL_HANDLE});
}

VkResult VKAPI_CALL too_many(VkDevice, const VkMemoryAllocateInfo*, const VkAllocationCallbacks*, VkDeviceMemory*) {
    return VK_ERROR_TOO_MANY_OBJECTS;
}

TEST_F(DeviceMemoryTest, TooManyAllocationsAreALackOfMemory) {
    const uint64_t before = device().memory_pool().allocated();
    const PFN_vkAllocateMemory allocate = std::exchange(vkAllocateMemory, &too_many);
    const std::string text = lack([] { buffer("one more", 40 * kMiB); });
    vkAllocateMemory = allocate;
    EXPECT_NE(text.find("too many objects"), std::string::npos) << text;
    EXPECT_EQ(device().memory_pool().allocated(), before) << "what failed does not count";
}

TEST(MemoryLimit, IsANumberOfMebibytes) {
    const auto limit_of = [](const char* text) {
        setenv("NEUVV_DEVICE_MEMORY", text, 1);
        const std::optional<uint64_t> limit = gpu::memory_limit_of_environment();
        return limit;
    };
    EXPECT_EQ(limit_of("512"), 512 * kMiB);
    EXPECT_EQ(limit_of(""), std::nullopt);
    for (const char* wrong : {"0", "-3", "lots", "12MiB", "1e3", "99999999999999999999"})
        expect_input_error([&] { limit_of(wrong); }, {"NEUVV_DEVICE_MEMORY", wrong, "MiB"});
    unsetenv("NEUVV_DEVICE_MEMORY");
    EXPECT_EQ(gpu::memory_limit_of_environment(), std::nullopt);
}

VkResult VKAPI_CALL lost(VkDevice, uint32_t, const VkFence*, VkBool32, uint64_t) {
    return VK_ERROR_DEVICE_LOST;
}

// Of two passes, the second has begun and not ended.
VkResult VKAPI_CALL timestamps_of_second(VkDevice, VkQueryPool, uint32_t, uint32_t count, size_t, void* data,
                                         VkDeviceSize, VkQueryResultFlags) {
    const uint64_t pairs[4][2] = {{1, 1}, {2, 1}, {3, 1}, {0, 0}};
    if (count == 4) std::memcpy(data, pairs, sizeof(pairs));
    return VK_NOT_READY;
}

TEST_F(DeviceMemoryTest, ALostDeviceIsSaidWithItsPass) {
    const gpu::Buffer words = buffer("words", 64);
    gpu::Commands commands(device(), "frame");
    commands.begin();
    for (const char* pass : {"slice", "trace"}) {
        const gpu::PassScope scope(commands, pass);
        gpu::fill(commands, words, 0);
        gpu::full_barrier(commands);
    }
    commands.submit();
    device().wait_idle();
    const auto wait = std::exchange(vkWaitForFences, &lost);
    const auto results = std::exchange(vkGetQueryPoolResults, &timestamps_of_second);
    std::string text;
    try {
        commands.wait();
    } catch (const gpu::VulkanError& error) {
        EXPECT_TRUE(error.device_lost());
        EXPECT_FALSE(error.out_of_memory());
        text = error.what();
    }
    vkWaitForFences = wait;
    vkGetQueryPoolResults = results;
    EXPECT_NE(text.find("frame, pass trace"), std::string::npos) << text;
    EXPECT_NE(text.find("device lost"), std::string::npos) << text;
    commands.wait();
}

}  // namespace
}  // namespace neuvv::test

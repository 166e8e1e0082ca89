// engine/gpu: uploads by a queue that only copies, which the layer of support/layers/transfer_queue.cpp gives the
// device. The validation layers stand before it and see a device with two queues.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <future>
#include <string>
#include <vector>

#include "gpu/commands.h"
#include "gpu/host_copies.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

// Before the first device is made. The layer that is found first is the one that the program calls.
[[maybe_unused]] const bool kHasLayer = [] {
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation:VK_LAYER_NEUVV_transfer_queue", 1);
    const char* given = std::getenv("VK_LAYER_PATH");  // of the validation layers
    const std::string validation = given ? given : "/usr/share/vulkan/explicit_layer.d";
    setenv("VK_LAYER_PATH", (validation + ":" NEUVV_TRANSFER_QUEUE_LAYER).c_str(), 1);
    return true;
}();

std::vector<uint32_t> numbers(size_t count, uint32_t seed) {
    std::vector<uint32_t> all(count);
    for (size_t i = 0; i < count; ++i) all[i] = static_cast<uint32_t>(i) * 2654435761u + seed;
    return all;
}

std::vector<uint32_t> downloaded(const gpu::Buffer& buffer, size_t count) {
    std::vector<uint32_t> all(count);
    gpu::download(*buffer.device, buffer, all.data(), count * sizeof(uint32_t));
    return all;
}

class TransferQueueTest : public GpuTest {
  protected:
    void SetUp() override { ASSERT_NE(device().transfer_queue(), nullptr); }

    // What the next submission to the main queue would wait for.
    static std::optional<VkSemaphoreSubmitInfo> wait_of_next() {
        const std::lock_guard lock(device().queue_mutex());
        return device().transfer_queue()->unseen();
    }
};

TEST_F(TransferQueueTest, IsOfAnotherFamilyThatNeitherComputesNorDraws) {
    EXPECT_TRUE(device().summary().transfer_queue);
    EXPECT_NE(device().transfer_queue()->family(), device().queue_family());
}

// Longer than a staging buffer, so that there are two submissions.
TEST_F(TransferQueueTest, TheMainQueueReadsWhatWasUploaded) {
    const std::vector<uint32_t> values = numbers((size_t{16} << 20) + 1023, 7);
    const gpu::Buffer buffer = gpu::uploaded(device(), "numbers", values, VK_FORMAT_R32_UINT);
    EXPECT_EQ(downloaded(buffer, values.size()), values);
}

// One submission to the main queue waits for an upload, and those after it do not wait again.
TEST_F(TransferQueueTest, OneSubmissionWaitsForEachUpload) {
    const auto submit_to_main_queue = [] { gpu::run_once(device(), "nothing", [](gpu::Commands&) {}); };
    submit_to_main_queue();
    EXPECT_FALSE(wait_of_next());
    const std::vector<uint32_t> values = numbers(100, 1);
    const gpu::Buffer buffer = gpu::uploaded(device(), "numbers", values, VK_FORMAT_R32_UINT);
    const auto first = wait_of_next();
    ASSERT_TRUE(first);
    uint64_t reached = 0;
    ASSERT_EQ(vkGetSemaphoreCounterValue(device().handle(), first->semaphore, &reached), VK_SUCCESS);
    EXPECT_GE(reached, first->value) << "it must not hold the queue up";
    submit_to_main_queue();
    EXPECT_FALSE(wait_of_next());
    gpu::upload(device(), buffer, values.data(), buffer.bytes / 2);
    const auto second = wait_of_next();
    ASSERT_TRUE(second);
    EXPECT_GT(second->value, first->value);
}

TEST_F(TransferQueueTest, ThreadsUploadWhileTheMainQueueWorks) {
    std::atomic<bool> is_done = false, draws = false;
    auto drawing = std::async(std::launch::async, [&] {
        const gpu::Buffer target(device(), "drawn", 1 << 20, gpu::MemoryKind::kDevice);
        while (!is_done) {
            gpu::run_once(device(), "draw", [&](gpu::Commands& to) { gpu::fill(to, target, 1); });
            draws = true;
            draws.notify_all();
            device().wait_idle();
        }
    });
    draws.wait(false);
    constexpr uint32_t kThreads = 3, kUploads = 20;
    std::vector<std::future<uint32_t>> threads;
    for (uint32_t thread = 0; thread < kThreads; ++thread)
        threads.push_back(std::async(std::launch::async, [thread] {
            uint32_t wrong = 0;
            for (uint32_t i = 0; i < kUploads; ++i) {
                const std::vector<uint32_t> values = numbers(10000 + 1000 * size_t{i}, thread * kUploads + i);
                const gpu::Buffer buffer = gpu::uploaded(device(), "numbers", values, VK_FORMAT_R32_UINT);
                wrong += downloaded(buffer, values.size()) != values;
            }
            return wrong;
        }));
    for (auto& thread : threads) thread.wait();
    is_done = true;
    drawing.get();
    for (auto& thread : threads) EXPECT_EQ(thread.get(), 0u);
}

TEST_F(TransferQueueTest, WaitingForTheDeviceWaitsForBothQueues) {
    const gpu::Buffer from = gpu::uploaded(device(), "from", numbers(1 << 20, 3), VK_FORMAT_R32_UINT);
    const gpu::Buffer to(device(), "to", from.bytes, gpu::MemoryKind::kDevice);
    gpu::Commands commands(device(), "copy", 1, gpu::QueueKind::kTransfer);
    commands.begin();
    gpu::copy(commands, from, to, from.bytes);
    commands.submit();
    device().wait_idle();
    EXPECT_TRUE(commands.is_done());
    commands.wait();
    EXPECT_EQ(downloaded(to, 1 << 20), numbers(1 << 20, 3));
}

}  // namespace
}  // namespace neuvv::test

// Errors that end the render thread, and errors that it only reports.
#include "editor/render_thread.h"

#include <chrono>
#include <functional>
#include <thread>

#include "edit/operations.h"
#include "support/gpu_test.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

struct RenderThreads : GpuTest {
    TemporaryFolder folder;
    editor::RenderThread thread{device(), [] {}};

    RenderThreads() {
        edit::Document document;
        document.file = edit::new_stage(folder.path / "stage.gltf");
        thread.show(std::make_shared<const edit::Document>(std::move(document)), 1);
    }
    // Waits until `reached` is true of the render thread's state; returns false after a minute.
    bool wait_for(const std::function<bool(const editor::RenderThreadState&)>& reached) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
        while (std::chrono::steady_clock::now() < end) {
            if (reached(thread.state())) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return false;
    }
};

TEST_F(RenderThreads, TellWhatADeviceHasNoRoomForAndGoOn) {
    thread.post([](editor::OnDevice&) {
        throw gpu::VulkanError(VK_ERROR_OUT_OF_DEVICE_MEMORY, "vkAllocateMemory", "a field");
    });
    EXPECT_TRUE(
        wait_for([](const auto& state) { return state.problem.find("out of device memory") != std::string::npos; }));
    bool done = false;
    thread.post([&](editor::OnDevice&) { done = true; });
    thread.post([](editor::OnDevice&) { throw InputError("clip.nvv", "", "is damaged"); });
    EXPECT_TRUE(wait_for([](const auto& state) { return state.problem.find("clip.nvv") != std::string::npos; }));
    thread.stop();
    EXPECT_TRUE(done);
}

TEST_F(RenderThreads, EndWithALostDevice) {
    thread.post([](editor::OnDevice&) { throw gpu::VulkanError(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2", "frame"); });
    EXPECT_THROW(wait_for([](const auto&) { return false; }), gpu::VulkanError);
}

}  // namespace
}  // namespace neuvv::test

// What ends the drawer's thread, and what it only tells.
#include "tools/viewer/drawer.h"

#include <chrono>
#include <functional>
#include <thread>

#include "edit/operations.h"
#include "support/gpu_test.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

struct Drawers : GpuTest {
    TemporaryFolder folder;
    viewer::Drawer drawer{device(), [] {}};

    Drawers() {
        edit::Document document;
        document.file = edit::new_stage(folder.path / "stage.gltf");
        drawer.show(std::make_shared<const edit::Document>(std::move(document)), 1);
    }
    // Until `reached` is true of the drawer's state; false after a minute.
    bool wait_for(const std::function<bool(const viewer::DrawerState&)>& reached) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
        while (std::chrono::steady_clock::now() < end) {
            if (reached(drawer.state())) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return false;
    }
};

TEST_F(Drawers, TellWhatADeviceHasNoRoomForAndGoOn) {
    drawer.post([](viewer::OnDevice&) {
        throw gpu::VulkanError(VK_ERROR_OUT_OF_DEVICE_MEMORY, "vkAllocateMemory", "a field");
    });
    EXPECT_TRUE(
        wait_for([](const auto& state) { return state.problem.find("out of device memory") != std::string::npos; }));
    bool done = false;
    drawer.post([&](viewer::OnDevice&) { done = true; });
    drawer.post([](viewer::OnDevice&) { throw InputError("clip.nvv", "", "is damaged"); });
    EXPECT_TRUE(wait_for([](const auto& state) { return state.problem.find("clip.nvv") != std::string::npos; }));
    drawer.stop();
    EXPECT_TRUE(done);
}

TEST_F(Drawers, EndWithALostDevice) {
    drawer.post([](viewer::OnDevice&) { throw gpu::VulkanError(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2", "frame"); });
    EXPECT_THROW(wait_for([](const auto&) { return false; }), gpu::VulkanError);
}

}  // namespace
}  // namespace neuvv::test

// Errors that end the render thread, and errors that it only reports.
#include "editor/draw/render_thread.h"

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "edit/operations.h"
#include "stream/served_stream.h"
#include "support/figure.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/temporary_folder.h"
#include "voctree/files/nvv.h"

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

// The device is not really lost here: it takes its own place.
TEST_F(RenderThreads, BeginAgainOnAnotherDevice) {
    editor::ViewRequest view;
    view.id = 1;
    view.camera = look_at({0, 0.5, 3}, {0, 0.5, 0}, 48, 36, 1);
    const auto is_drawn = [&](const auto& state) {
        return state.displayed.finished && state.displayed.view == view.id;
    };
    thread.request(view);
    ASSERT_TRUE(wait_for(is_drawn));
    const uint64_t bytes = device().buffer_bytes();
    thread.post([](editor::OnDevice&) { throw gpu::VulkanError(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2", "frame"); });
    EXPECT_THROW(wait_for([](const auto&) { return false; }), gpu::VulkanError);
    bool ran = false;
    thread.post(
        [&](editor::OnDevice& on) { ran = &on.device == &device() && on.renderer.frames().slices().budget() > 0; });
    thread.release();
    EXPECT_LT(device().buffer_bytes(), bytes / 4) << "what it had on the device is gone";
    thread.restart();
    EXPECT_EQ(thread.state().displayed.image, nullptr);
    EXPECT_FALSE(thread.state().displayed.finished);
    edit::Document document;
    document.file = edit::new_stage(folder.path / "stage.gltf");
    thread.show(std::make_shared<const edit::Document>(std::move(document)), 2);
    view.id = 2;
    thread.request(view);
    EXPECT_TRUE(wait_for(is_drawn)) << thread.state().problem;
    EXPECT_NE(thread.state().displayed.image, nullptr);
    thread.stop();
    EXPECT_TRUE(ran) << "tasks that waited run on the new one";
}

// Views go on while the clip of a new performer is read, here from a server that does not answer yet.
TEST_F(RenderThreads, DrawTheStageBeforeUntilANewClipIsRead) {
    ServedStream served;
    served.start(3);
    editor::ViewRequest view;
    view.camera = look_at({0, 0.5, 3}, {0, 0.5, 0}, 48, 36, 1);
    const auto show = [&](uint64_t id) {
        view.id = id;
        view.camera = look_at({0, 0.5 + 0.01 * static_cast<double>(id), 3}, {0, 0.5, 0}, 48, 36, 1);
        thread.request(view);
        return wait_for([&](const auto& state) { return state.displayed.view == id; });
    };
    ASSERT_TRUE(show(1)) << thread.state().problem;
    const auto with_performer = [&](const std::filesystem::path& clip) {
        edit::Document document;
        document.file = edit::new_stage(folder.path / "show.gltf");
        edit::PerformerEdit performer;
        performer.clip = clip;
        edit::add_performer(document.file, "anna", performer, {});
        return std::make_shared<const edit::Document>(std::move(document));
    };
    thread.show(with_performer(served.address("shut")), 2);
    ASSERT_TRUE(wait_for([](const auto& state) { return state.loading == "show.nvs"; }));
    bool ran = false, ran_on_new = false;
    thread.post([&](editor::OnDevice& on) {
        ran = true;
        ran_on_new = on.stage.performers.size() == 1;
    });
    for (uint64_t id = 3; id < 6; ++id) {
        ASSERT_TRUE(show(id)) << "images go on";
        EXPECT_EQ(thread.state().displayed.stage, 1u);
    }
    EXPECT_FALSE(ran) << "a task is for the stage that was sent last";
    EXPECT_EQ(thread.state().loading, "show.nvs");
    std::ofstream(served.folder.path / "open").put('1');
    ASSERT_TRUE(wait_for([](const auto& state) { return state.stage_id == 2; })) << thread.state().problem;
    ASSERT_TRUE(wait_for([&](const auto& state) { return state.displayed.stage == 2 && state.displayed.finished; }));
    EXPECT_EQ(thread.state().loading, "");
    ASSERT_EQ(thread.state().stage->performers.size(), 1u);
    thread.show(with_performer(folder.path / "nobody.nvv"), 3);
    ASSERT_TRUE(wait_for([](const auto& state) { return state.problem.find("nobody.nvv") != std::string::npos; }));
    EXPECT_EQ(thread.state().stage_id, 2u) << "the stage before stays";
    EXPECT_EQ(thread.state().loading, "");
    thread.stop();
    EXPECT_TRUE(ran_on_new);
}

// The second of two clips is on a server that does not answer.
TEST_F(RenderThreads, CountTheClipsThatAreRead) {
    ASSERT_TRUE(wait_for([](const auto& state) { return state.stage_id == 1; })) << thread.state().problem;
    ServedStream served;
    served.start(3);
    voctree::write_nvv(folder.path / "figure.nvv", figure_tree());
    edit::Document document;
    document.file = edit::new_stage(folder.path / "show.gltf");
    for (const std::filesystem::path clip : {(folder.path / "figure.nvv").string(), served.address("shut")}) {
        edit::PerformerEdit performer;
        performer.clip = clip;
        edit::add_performer(document.file, clip.stem().string(), performer, {});
    }
    thread.show(std::make_shared<const edit::Document>(std::move(document)), 2);
    EXPECT_TRUE(wait_for([](const auto& state) { return state.loading == "show.nvs"; })) << thread.state().loading;
    EXPECT_EQ(thread.state().files_read, 1u);
    EXPECT_EQ(thread.state().files, 2u);
    std::ofstream(served.folder.path / "open").put('1');
    ASSERT_TRUE(wait_for([](const auto& state) { return state.stage_id == 2; })) << thread.state().problem;
    EXPECT_EQ(thread.state().loading, "");
    thread.stop();
}

// A performer of another scene is not drawn: its clip may be missing.
TEST_F(RenderThreads, ReadNoClipsOfOtherScenes) {
    ASSERT_TRUE(wait_for([](const auto& state) { return state.stage_id == 1; })) << thread.state().problem;
    edit::Document document;
    document.file = edit::new_stage(folder.path / "show.gltf");
    edit::PerformerEdit performer;
    performer.clip = folder.path / "nobody.nvv";
    edit::add_performer(document.file, "anna", performer, {});
    auto& scenes = document.file.json.edit("scenes");
    scenes.push_back({{"nodes", {scenes[0]["nodes"].back()}}});
    scenes[0]["nodes"].erase(scenes[0]["nodes"].size() - 1);
    if (scenes[0]["nodes"].empty()) scenes[0].erase("nodes");
    thread.show(std::make_shared<const edit::Document>(std::move(document)), 2);
    ASSERT_TRUE(wait_for([](const auto& state) { return state.stage_id == 2 || !state.problem.empty(); }));
    EXPECT_EQ(thread.state().problem, "");
    EXPECT_EQ(thread.state().stage_id, 2u);
    EXPECT_TRUE(thread.state().stage->performers.empty());
}

// A server that does not answer holds up neither tasks nor other views.
TEST_F(RenderThreads, ShowWhatTheyHaveUntilAServerSendsTheRest) {
    ServedStream served;
    served.start(3);
    edit::Document document;
    document.file = edit::new_stage(folder.path / "show.gltf");
    edit::PerformerEdit performer;
    performer.clip = served.address("gate");
    edit::add_performer(document.file, "anna", performer, {});
    thread.show(std::make_shared<const edit::Document>(std::move(document)), 2);
    editor::ViewRequest view;
    view.camera = look_at({0, 0.5, 3}, {0, 0.5, 0}, 48, 36, 1);
    const auto show = [&](uint64_t id, double time_s) {
        view.id = id;
        view.time_s = time_s;
        thread.request(view);
    };
    show(1, 0);
    ASSERT_TRUE(wait_for([](const auto& state) { return state.displayed.finished && state.displayed.view == 1; }))
        << thread.state().problem;
    EXPECT_FALSE(thread.state().waits_since);
    show(2, 0.08);
    ASSERT_TRUE(wait_for([](const auto& state) { return state.waits_since.has_value(); })) << thread.state().problem;
    bool ran = false;
    thread.post([&](editor::OnDevice&) { ran = true; });
    view.camera = look_at({0, 0.6, 3}, {0, 0.5, 0}, 48, 36, 1);
    show(3, 0.08);
    ASSERT_TRUE(wait_for([](const auto& state) { return state.displayed.view == 3; }));
    EXPECT_TRUE(ran);
    EXPECT_FALSE(thread.state().displayed.finished);
    EXPECT_TRUE(thread.state().waits_since);
    std::ofstream(served.folder.path / "open").put('1');
    ASSERT_TRUE(wait_for([](const auto& state) { return state.displayed.finished && state.displayed.view == 3; }));
    EXPECT_FALSE(thread.state().waits_since);
    EXPECT_EQ(thread.state().problem, "");
}

}  // namespace
}  // namespace neuvv::test

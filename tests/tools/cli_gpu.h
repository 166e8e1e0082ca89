// What tests of the command line with a device share: a scene, and a data set that shows it.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "render/frame/frame_renderer.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"
#include "tests/tools/run_neuvv.h"
#include "tools/view_path.h"
#include "training/evaluation/evaluate.h"
#include "voctree/files/nvv.h"
#include "voctree/files/occupied_box.h"

namespace neuvv {

inline size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

constexpr float kOwnFps = 2;  // an orbit of four frames takes four seconds: eight images

inline voctree::VOctree own_tree() {
    return test::random_tree({.leaves = 200, .frames = 4});
}

inline nlohmann::json frame_of(const tools::ViewStep& step, const std::string& image, double time) {
    nlohmann::json frame = {{"fl_x", step.camera.fx}, {"fl_y", step.camera.fy},      {"cx", step.camera.cx},
                            {"cy", step.camera.cy},   {"w", step.camera.width},      {"h", step.camera.height},
                            {"time", time},           {"file_path", "test/" + image}};
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            frame["transform_matrix"][row][column] = step.camera.world_from_camera[column][row];
    return frame;
}

// A data set of two cameras and three times that shows the tree exactly; one time lies between two frames.
inline void write_own_dataset(const gpu::Device& device, const voctree::VOctree& tree,
                              const std::filesystem::path& folder) {
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, {48, 40});
    std::filesystem::create_directories(folder / "test");
    nlohmann::json file;
    const std::vector<tools::ViewStep> orbit = tools::orbit_path(voctree::occupied_box(tree), {{0, 3}, 2, 2}, {48, 40});
    for (size_t c = 0; c < 2; ++c)
        for (int t = 0; t < 3; ++t) {
            const double time = t / 2.0;
            const std::string name = "c0" + std::to_string(c) + "_f" + std::to_string(t);
            render::FrameSettings settings;
            settings.instances[0].frame = static_cast<float>(training::frame_of_time(time, tree.frames));
            settings.width = 48;
            settings.height = 40;
            media::write_png(folder / "test" / (name + ".png"), renderer.render(orbit[3 * c].camera, settings));
            file["frames"].push_back(frame_of(orbit[3 * c], name, time));
        }
    write_text(folder / "transforms_test.json", file.dump());
}

struct CliGpu : test::GpuTest {
    TemporaryFolder folder;
    std::string scene = (folder.path / "scene.nvv").string();
    voctree::VOctree tree = own_tree();

    void SetUp() override {
        tree.fps = kOwnFps;
        voctree::write_nvv(scene, tree);
    }
    std::string file(const char* name) const { return (folder.path / name).string(); }
    // Writes the data set of own_tree() into "data". Its images are rendered once for all tests.
    void write_own_data() const {
        static const TemporaryFolder made;
        static const bool written = (write_own_dataset(device(), own_tree(), made.path), true);
        ASSERT_TRUE(written);
        std::filesystem::copy(made.path, folder.path / "data", std::filesystem::copy_options::recursive);
    }
};

}  // namespace neuvv

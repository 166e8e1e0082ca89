// neuvv view: opens the window in which clips and stages are watched and edited.
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/results.h"
#include "tools/viewer/viewer.h"

namespace neuvv::tools {

namespace {

struct ViewOptions {
    std::string file, size, report, screenshots, shaders, trainee;
    double ui_scale = 0;
    bool validate = false;
};

}  // namespace

void add_view(Command app, CommonOptions& common) {
    auto options = std::make_shared<ViewOptions>();
    Command verb = app.add_verb("view", "Watch and edit clips and stages in a window");
    verb.add_option(
        "file", options->file,
        "A stage (.gltf, .glb), a clip (.nvv, .nvs, or the .npz of a PlenOctree), the address of a .nvs, or a "
        "folder whose newest clip is shown as training goes on");
    verb.add_option("--size", options->size, "Of the window, as 1280x720; otherwise as it was last");
    verb.add_option("--ui-scale", options->ui_scale, "Of letters and panels; otherwise the monitor's")
        .number_between(0.5, 4);
    verb.add_option("--report", options->report,
                    "Keep this JSON file up to date with what the window shows and where, for programs that drive it");
    verb.add_option("--screenshots", options->screenshots,
                    "The folder for F12; otherwise the one for images ($XDG_PICTURES_DIR, ~/Pictures)");
    verb.add_option(
            "--shaders", options->shaders,
            "For who writes shaders: this folder of their sources is watched, and what changes is seen at once; a "
            "debug build watches the one that it was built from")
        .existing_folder();
    verb.add_option(
        "--trainee", options->trainee,
        "Compare somebody's motion with a performer's at once: vmc[:[HOST:]PORT], udp:[HOST:]PORT, - (lines "
        "of JSON), or a recorded file; the tab Coach says what is off");
    verb.add_flag("--validate", options->validate, "With Vulkan's validation layers, whose messages are in the report");
    verb.footer(
        {"Keys: ? in the window lists them.\n\n"
         "Examples:\n"
         "  neuvv view demo/performer.nvv\n"
         "  neuvv view demo/stage.gltf --size 1600x900\n"
         "  neuvv view demo/performer.nvv --trainee tools/performer/trainee.glb"});
    verb.callback([options, &common] {
        expect_there(options->file);  // before a window is opened
        if (!options->report.empty()) prepare_live_file("--report", options->report, kJsonEnding);
        viewer::Viewer::Options viewer;
        viewer.file = options->file;
        viewer.report = options->report;
        viewer.trainee = options->trainee;
        viewer.screenshots = options->screenshots;
        viewer.shaders =
            options->shaders.empty() ? editor::shaders_of_debug_build() : std::filesystem::path(options->shaders);
        viewer.validate = options->validate;
        if (options->ui_scale > 0) viewer.ui_scale = static_cast<float>(options->ui_scale);
        if (!options->size.empty()) {
            const media::ImageSize size = parse_size(options->size);
            viewer.size = VkExtent2D{size.width, size.height};
        }
        viewer::Viewer(viewer, common.device).run();
    });
}

}  // namespace neuvv::tools

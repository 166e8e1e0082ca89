// neuvv: one program, with a verb each for capture, training, measuring and rendering of volumetric video.
#include "neuvv_commit.h"
#include "tools/commands.h"

namespace {

void group_by_task(const neuvv::tools::Command& app) {
    app.group_verbs("Bring a capture", {"capture", "dataset", "matte"});
    app.group_verbs("Train and measure", {"train", "cluster", "eval"});
    app.group_verbs("Watch and render", {"view", "xr", "render"});
    app.group_verbs("Stage, paint and cut", {"stage", "paint", "clip"});
    app.group_verbs("Publish and exchange", {"publish", "convert", "export", "import"});
    app.group_verbs("Be coached by a performer", {"skeleton", "coach"});
    app.group_verbs("Look up", {"info", "devices"});
}

}  // namespace

int main(int argc, char** argv) {
    using namespace neuvv::tools;
    CommonOptions common;
    Program program("neuvv", "Neural volumetric video: capture, train, measure, render.", NEUVV_VERSION NEUVV_COMMIT,
                    common);
    Command app = program.command();
    for (const auto add : {add_capture, add_dataset, add_matte,    add_train, add_cluster, add_eval,    add_view,
                           add_xr,      add_render,  add_stage,    add_paint, add_clip,    add_publish, add_convert,
                           add_export,  add_import,  add_skeleton, add_coach, add_info,    add_devices})
        add(app, common);
    group_by_task(app);
    app.footer(
        {"`neuvv help VERB` tells more. Exit code: 0, 1 (failure), 2 (bad input).\n\n"
         "Examples (from the repository's root):\n"
         "  neuvv devices\n"
         "  neuvv capture tools/performer/performer.glb -o work/performer\n"
         "  neuvv dataset work/performer -o work/look\n"
         "  neuvv train work/performer -o work/performer.nvv\n"
         "  neuvv eval work/performer.nvv work/performer --json work/metrics.json\n"
         "  neuvv render work/performer.nvv -o work/turn.mp4\n"
         "  neuvv view work/performer.nvv"});
    return program.run(argc, argv);
}

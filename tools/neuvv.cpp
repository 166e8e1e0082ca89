// neuvv: one program, with a verb each for capture, training, measuring and rendering of volumetric video.
#include "tools/commands.h"

int main(int argc, char** argv) {
    using namespace neuvv::tools;
    CommonOptions common;
    Program program("neuvv", "Neural volumetric video: capture, train, measure, render.", common);
    Command app = program.command();
    for (const auto add : {add_devices, add_info,  add_capture, add_dataset, add_matte,  add_skeleton, add_train,
                           add_cluster, add_eval,  add_convert, add_publish, add_export, add_import,   add_clip,
                           add_render,  add_stage, add_paint,   add_view,    add_coach,  add_xr})
        add(app, common);
    app.footer(
        {"Exit code: 0, 1 (failure), 2 (bad input). `neuvv VERB --help` tells more.\n\n"
         "Examples (from the repository's root):\n"
         "  neuvv devices\n"
         "  neuvv capture tools/performer/performer.glb -o build/performer\n"
         "  neuvv dataset build/performer -o build/look\n"
         "  neuvv train build/performer -o build/performer.nvv\n"
         "  neuvv eval build/performer.nvv build/performer --json build/metrics.json\n"
         "  neuvv render build/performer.nvv -o build/turn.mp4\n"
         "  neuvv view build/performer.nvv"});
    return program.run(argc, argv);
}

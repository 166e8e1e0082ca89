// neuvv: one program, one verb each for capture, training, measuring and rendering of volumetric video.
#include "tools/program.h"

int main(int argc, char** argv) {
    using namespace neuvv;
    CLI::App app{"Neural volumetric video: capture, train, measure, render.", "neuvv"};
    tools::CommonOptions common;
    tools::set_up_program(app, common);
    tools::add_devices(app, common);
    tools::add_info(app, common);
    tools::add_capture(app, common);
    tools::add_dataset(app, common);
    tools::add_matte(app, common);
    tools::add_train(app, common);
    tools::add_eval(app, common);
    tools::add_convert(app, common);
    tools::add_render(app, common);
    tools::add_stage(app, common);
    tools::add_paint(app, common);
    tools::add_view(app, common);
    tools::add_xr(app, common);
    app.footer(
        "Exit code: 0, 1 (failure), 2 (bad input). `neuvv VERB --help` tells more.\n\n"
        "Examples (from the repository's root):\n"
        "  neuvv devices\n"
        "  neuvv capture tools/performer/performer.glb -o build/performer\n"
        "  neuvv dataset build/performer -o build/look\n"
        "  neuvv train build/performer -o build/performer.nvv\n"
        "  neuvv eval build/performer.nvv build/performer --json build/metrics.json\n"
        "  neuvv render build/performer.nvv -o build/turn.mp4\n"
        "  neuvv view build/performer.nvv");
    return tools::run_program(app, argc, argv);
}

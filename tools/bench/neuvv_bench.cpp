// neuvv-bench: how fast passes run on a device, as medians over repeats and ratios within one run.
#include "neuvv_commit.h"
#include "tools/bench/measure.h"

int main(int argc, char** argv) {
    using namespace neuvv::bench;
    neuvv::tools::CommonOptions common;
    neuvv::tools::Program program(
        "neuvv-bench", "Measure how fast NeuVV runs on a device, beside the references that it is compared with.",
        NEUVV_VERSION NEUVV_COMMIT, common);
    neuvv::tools::Command app = program.command();
    for (const auto add : {add_open, add_render, add_slice, add_stream, add_walk, add_instances, add_far, add_stereo,
                           add_stage, add_play, add_xr, add_train, add_team, add_edit, add_coach})
        add(app, common);
    app.footer(
        {"Exit code: 0, 1 (failure), 2 (bad input). `neuvv-bench VERB --help` tells more.\n\n"
         "Examples, after `neuvv capture tools/performer/performer.glb -o work/performer` and\n"
         "`neuvv train work/performer -o work/performer.nvv`:\n"
         "  neuvv-bench render work/performer.nvv --views 2\n"
         "  neuvv-bench slice work/performer.nvv\n"
         "  neuvv-bench train work/performer.nvv work/performer --repeats 50"});
    return program.run(argc, argv);
}

// neuvv-bench: how fast passes run on a device, as medians over repeats and ratios within one run.
#include "tools/bench/verbs.h"
#include "tools/program.h"

int main(int argc, char** argv) {
    using namespace neuvv;
    CLI::App app{"Measure how fast NeuVV runs on a device, beside the references that it is compared with.",
                 "neuvv-bench"};
    tools::CommonOptions common;
    tools::set_up_program(app, common);
    bench::add_open(app, common);
    bench::add_render(app, common);
    bench::add_slice(app, common);
    bench::add_walk(app, common);
    bench::add_instances(app, common);
    bench::add_stereo(app, common);
    bench::add_stage(app, common);
    bench::add_xr(app, common);
    bench::add_train(app, common);
    bench::add_edit(app, common);
    app.footer(
        "Exit code: 0, 1 (failure), 2 (bad input). `neuvv-bench VERB --help` tells more.\n\n"
        "Examples, after `neuvv capture tools/performer/performer.glb -o build/performer` and\n"
        "`neuvv train build/performer -o build/performer.nvv`:\n"
        "  neuvv-bench render build/performer.nvv --views 2\n"
        "  neuvv-bench slice build/performer.nvv\n"
        "  neuvv-bench train build/performer.nvv build/performer --repeats 50");
    return tools::run_program(app, argc, argv);
}

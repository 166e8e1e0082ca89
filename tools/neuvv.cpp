// neuvv: one program, one verb each for capture, training, measuring and rendering of volumetric video.
#include <fmt/format.h>

#include <cstdio>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "gpu/debug_buffer.h"
#include "tools/commands.h"

namespace {

constexpr int kFailure = 1, kBadInput = 2;

// What stands below a verb.
std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App* verb) { return !verb->get_name().empty(); });
}

// The verb that the user reached, as typed: "stage set".
std::pair<const CLI::App*, std::string> reached_verb(const CLI::App* app) {
    std::string path;
    for (auto below = app->get_subcommands(); !below.empty(); below = app->get_subcommands()) {
        app = below[0];
        path += (path.empty() ? "" : " ") + app->get_name();
    }
    return {app, path};
}

// One line: what is wrong, and where to look.
std::string usage_error(const CLI::App* app, const CLI::Error& error) {
    const auto [verb, path] = reached_verb(app);
    std::string problem = error.what();
    const auto unknown = app->remaining(true);
    const auto below = verbs_of(*verb);
    const bool typed = !unknown.empty() && !unknown[0].starts_with('-');
    if (!below.empty() && (typed || problem.find("subcommand") != std::string::npos)) {
        std::string names;
        for (const CLI::App* one : below) names += (names.empty() ? "" : ", ") + one->get_name();
        problem = typed ? fmt::format("there is no `{}{}{}`", path, path.empty() ? "" : " ", unknown[0])
                        : fmt::format("`neuvv{}{}` needs a verb", path.empty() ? "" : " ", path);
        problem += "; choose from " + names;
    }
    for (char& c : problem)
        if (c == '\n' || c == '\r') c = ' ';
    return fmt::format("neuvv: {}; `neuvv {}{}--help` shows how\n", problem, path, path.empty() ? "" : " ");
}

int run(int argc, char** argv) {
    neuvv::gpu::set_shader_message_sink([](const std::string& line) { fmt::print(stderr, "shader: {}\n", line); });
    CLI::App app{"Neural volumetric video: capture, train, measure, render.", "neuvv"};
    app.require_subcommand(1);
    app.failure_message(usage_error);
    app.set_version_flag("--version", NEUVV_VERSION);
    neuvv::tools::CommonOptions common;
    app.add_option("--device", common.device, "Vulkan device: an index or part of a name (see `neuvv devices`)")
        ->envname("NEUVV_DEVICE");
    app.fallthrough();
    neuvv::tools::add_devices(app, common);
    neuvv::tools::add_info(app, common);
    neuvv::tools::add_capture(app, common);
    neuvv::tools::add_dataset(app, common);
    neuvv::tools::add_matte(app, common);
    neuvv::tools::add_train(app, common);
    neuvv::tools::add_eval(app, common);
    neuvv::tools::add_bench(app, common);
    neuvv::tools::add_convert(app, common);
    neuvv::tools::add_render(app, common);
    neuvv::tools::add_stage(app, common);
    neuvv::tools::add_paint(app, common);
    neuvv::tools::add_view(app, common);
    neuvv::tools::add_xr(app, common);
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
    try {
        app.parse(argc, argv);
    } catch (const CLI::RuntimeError& error) {  // a verb that has said already why it stops
        return error.get_exit_code();
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kBadInput;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const int code = run(argc, argv);
        if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
        fmt::print(stderr, "neuvv: the results could not be written to the standard output\n");
        return kFailure;
    } catch (const neuvv::InputError& error) {
        fmt::print(stderr, "neuvv: {}\n", error.what());
        return kBadInput;
    } catch (const std::exception& error) {
        fmt::print(stderr, "neuvv: {}\n", error.what());
        return kFailure;
    }
}

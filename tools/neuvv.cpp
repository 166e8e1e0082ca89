// neuvv: one program, one verb each for capture, training, measuring and rendering of volumetric video.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "tools/commands.h"

namespace {

constexpr int kFailure = 1, kBadInput = 2;

int run(int argc, char** argv) {
    CLI::App app{"Neural volumetric video: capture, train, measure, render.", "neuvv"};
    app.require_subcommand(1);
    neuvv::CommonOptions common;
    app.add_option("--device", common.device, "Vulkan device: an index or part of a name (see `neuvv devices`)")
        ->envname("NEUVV_DEVICE");
    app.fallthrough();
    neuvv::add_capture(app, common);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kBadInput;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const neuvv::InputError& error) {
        fmt::print(stderr, "neuvv: {}\n", error.what());
        return kBadInput;
    } catch (const std::exception& error) {
        fmt::print(stderr, "neuvv: {}\n", error.what());
        return kFailure;
    }
}

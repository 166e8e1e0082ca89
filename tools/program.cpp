#include "tools/program.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>
#include <vector>

#include "base/error.h"
#include "gpu/debug_buffer.h"

namespace neuvv::tools {

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
    const std::string& program = app->get_name();
    std::string problem = error.what();
    const auto unknown = app->remaining(true);
    const auto below = verbs_of(*verb);
    const bool typed = !unknown.empty() && !unknown[0].starts_with('-');
    if (!below.empty() && (typed || problem.find("subcommand") != std::string::npos)) {
        std::string names;
        for (const CLI::App* one : below) names += (names.empty() ? "" : ", ") + one->get_name();
        problem = typed ? fmt::format("there is no `{}{}{}`", path, path.empty() ? "" : " ", unknown[0])
                        : fmt::format("`{}{}{}` needs a verb", program, path.empty() ? "" : " ", path);
        problem += "; choose from " + names;
    }
    for (char& c : problem)
        if (c == '\n' || c == '\r') c = ' ';
    return fmt::format("{0}: {1}; `{0} {2}{3}--help` shows how\n", program, problem, path, path.empty() ? "" : " ");
}

int parse(CLI::App& app, int argc, char** argv) {
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

void set_up_program(CLI::App& app, CommonOptions& common) {
    gpu::set_shader_message_sink([](const std::string& line) { fmt::print(stderr, "shader: {}\n", line); });
    app.require_subcommand(1);
    app.failure_message(usage_error);
    app.set_version_flag("--version", NEUVV_VERSION);
    app.add_option("--device", common.device, "Vulkan device: an index or part of a name (see `neuvv devices`)")
        ->envname("NEUVV_DEVICE");
    app.fallthrough();
}

int run_program(CLI::App& app, int argc, char** argv) {
    const char* program = app.get_name().c_str();
    try {
        const int code = parse(app, argc, argv);
        if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
        fmt::print(stderr, "{}: the results could not be written to the standard output\n", program);
        return kFailure;
    } catch (const InputError& error) {
        fmt::print(stderr, "{}: {}\n", program, error.what());
        return kBadInput;
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", program, error.what());
        return kFailure;
    }
}

}  // namespace neuvv::tools

#include "tools/commands.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>
#include <vector>

#include "base/error.h"
#include "gpu/debug_buffer.h"
#include "training/formats.h"

namespace neuvv::tools {

namespace {

constexpr int kFailure = 1, kBadInput = 2;

// The verbs that stand directly below one, or below the program.
std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App* verb) { return !verb->get_name().empty(); });
}

// The last verb that the user named, and the verbs up to it as typed: "stage set".
std::pair<const CLI::App*, std::string> named_verb(const CLI::App* app) {
    std::string path;
    for (auto below = app->get_subcommands(); !below.empty(); below = app->get_subcommands()) {
        app = below[0];
        path += (path.empty() ? "" : " ") + app->get_name();
    }
    return {app, path};
}

// One line that says what is wrong and which --help shows how it is done.
std::string usage_error(const CLI::App* app, const CLI::Error& error) {
    const auto [verb, path] = named_verb(app);
    const std::string& program = app->get_name();
    std::string problem = error.what();
    const auto unknown = app->remaining(true);
    const auto below = verbs_of(*verb);
    const bool typed = !unknown.empty() && !unknown[0].starts_with('-');
    if (!below.empty() && (typed || problem.find("subcommand") != std::string::npos)) {
        std::string names;
        for (const CLI::App* choice : below) names += (names.empty() ? "" : ", ") + choice->get_name();
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
    } catch (const CLI::RuntimeError& error) {  // from a verb that has already said why it stops
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

CLI::Validator number_between(double low, double high) {
    return CLI::Validator(
        [low, high](const std::string& text) {
            double value = 0;
            const bool number = CLI::detail::lexical_cast(text, value);
            if (number && value >= low && value <= high) return std::string();
            return fmt::format("{} is no number from {} to {}", text, low, high);
        },
        fmt::format("[{} - {}]", low, high));
}

CLI::Option* add_switch(CLI::App& verb, const std::string& name, std::optional<bool>& value, const std::string& help) {
    return verb.add_option(name, value, help + ": on or off")->check(CLI::IsMember({"on", "off"}));
}

CLI::Option* add_samples_option(CLI::App& verb, uint32_t& samples) {
    return verb
        .add_option("--samples", samples, "Rays a pixel along each side: 2 averages 4 of them, for smooth edges")
        ->check(CLI::Range(1, 4))
        ->capture_default_str();
}

void add_slice_budget_option(CLI::App& verb, double& mebibytes) {
    verb.add_option("--slice-budget", mebibytes,
                    "MiB on the device for frames' slices that are kept, however many instances there are; 0: no "
                    "slices, all numbers at each sample (slow)")
        ->check(number_between(0, 1048576))
        ->capture_default_str();
}

void add_format_option(CLI::App& verb, std::string& format) {
    verb.add_option("--format", format, "The data set's layout; auto: by the files in it")
        ->check(CLI::IsMember(training::format_names()))
        ->capture_default_str();
}

}  // namespace neuvv::tools

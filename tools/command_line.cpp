#include "tools/command_line.h"

#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/output_path.h"
#include "base/trace_file.h"
#include "gpu/debug_buffer.h"
#include "tools/commands.h"

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
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kBadInput;
    }
    return 0;
}

// A verb that failed leaves a trace, too.
int parse_and_trace(CLI::App& app, int argc, char** argv, const std::string& trace_file) {
    const auto write = [&] {
        if (is_tracing()) write_trace(trace_file);
    };
    try {
        const int code = parse(app, argc, argv);
        write();
        return code;
    } catch (...) {
        try {
            write();
        } catch (const RuntimeFailure&) {  // what the verb says matters more
        }
        throw;
    }
}

}  // namespace

Option Option::required() const {
    return Option(option_->required());
}

Option Option::show_default() const {
    return Option(option_->capture_default_str());
}

Option Option::excludes(Option other) const {
    return Option(option_->excludes(other.option_));
}

Option Option::needs(Option other) const {
    return Option(option_->needs(other.option_));
}

Option Option::delimiter(char between) const {
    return Option(option_->delimiter(between));
}

Option Option::expected(int values) const {
    return Option(option_->expected(values));
}

Option Option::environment(const std::string& name) const {
    return Option(option_->envname(name));
}

template <typename Whole>
Option Option::in_range(Whole low, Whole high) const {
    return Option(option_->check(CLI::Range(low, high)));
}
template Option Option::in_range(int, int) const;
template Option Option::in_range(int64_t, int64_t) const;
template Option Option::in_range(uint32_t, uint32_t) const;

// CLI::Range takes NaN for a number between any two.
Option Option::number_between(double low, double high) const {
    return Option(option_->check(CLI::Validator(
        [low, high](const std::string& text) {
            double value = 0;
            const bool number = CLI::detail::lexical_cast(text, value);
            if (number && value >= low && value <= high) return std::string();
            return fmt::format("{} is no number from {} to {}", text, low, high);
        },
        fmt::format("[{} - {}]", low, high))));
}

Option Option::one_of(const std::vector<std::string>& names) const {
    return Option(option_->check(CLI::IsMember(names)));
}

Option Option::not_negative() const {
    return Option(option_->check(CLI::NonNegativeNumber));
}

Option Option::existing_folder() const {
    return Option(option_->check(CLI::ExistingDirectory));
}

Command Command::add_verb(const std::string& name, const std::string& description) const {
    return Command(command_->add_subcommand(name, description));
}

Command Command::add_group(const std::string& title) const {
    return Command(command_->add_option_group(title));
}

template <typename Value>
Option Command::add_option(const std::string& name, Value& value, const std::string& description) const {
    return Option(command_->add_option(name, value, description));
}
template Option Command::add_option(const std::string&, std::string&, const std::string&) const;
template Option Command::add_option(const std::string&, float&, const std::string&) const;
template Option Command::add_option(const std::string&, int&, const std::string&) const;
template Option Command::add_option(const std::string&, std::filesystem::path&, const std::string&) const;
template Option Command::add_option(const std::string&, double&, const std::string&) const;
template Option Command::add_option(const std::string&, int64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, uint32_t&, const std::string&) const;
template Option Command::add_option(const std::string&, uint64_t&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<bool>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<uint32_t>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<uint64_t>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::optional<std::string>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<double>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<uint32_t>&, const std::string&) const;
template Option Command::add_option(const std::string&, std::vector<std::string>&, const std::string&) const;

Option Command::add_flag(const std::string& name, bool& value, const std::string& description) const {
    return Option(command_->add_flag(name, value, description));
}

Option Command::add_parsed_option(const std::string& name, std::function<void(const std::string& value)> take,
                                  const std::string& description) const {
    const std::function<void(const std::string&)> parsed = [name, take = std::move(take)](const std::string& value) {
        try {
            take(value);
        } catch (const Finished&) {
            throw CLI::Success();
        } catch (const WrongValue& wrong) {
            throw CLI::ValidationError(name, wrong.problem);
        }
    };
    return Option(command_->add_option_function<std::string>(name, parsed, description));
}

void Command::footer(std::initializer_list<std::string_view> parts) const {
    std::string text;
    for (const std::string_view part : parts) text += part;
    command_->footer(text);
}

void Command::callback(std::function<void()> run) const {
    command_->callback(std::move(run));
}

void Command::require_verb() const {
    command_->require_subcommand(1);
}

void Command::require_options(size_t low, size_t high) const {
    command_->require_option(low, high);
}

size_t Command::count(const std::string& option) const {
    return command_->count(option);
}

size_t Command::count_all() const {
    return command_->count_all();
}

Program::Program(const std::string& name, const std::string& description, CommonOptions& common)
    : app_(std::make_unique<CLI::App>(description, name)), common_(common) {
    gpu::set_shader_message_sink([](const std::string& line) { fmt::print(stderr, "shader: {}\n", line); });
    app_->require_subcommand(1);
    app_->failure_message(usage_error);
    app_->set_version_flag("--version", NEUVV_VERSION);
    app_->add_option("--device", common.device, "Vulkan device: an index or part of a name (see `neuvv devices`)")
        ->envname("NEUVV_DEVICE");
    // Options are parsed before verbs run.
    app_->add_option("--trace", common.trace,
                     "Write what threads and the device did when, for https://ui.perfetto.dev, to this .json");
    app_->parse_complete_callback([&common] {
        if (common.trace.empty()) return;
        prepare_output_file("--trace", common.trace);
        name_trace_thread("main thread");
        begin_trace();
    });
    app_->fallthrough();
}

Program::~Program() = default;

int Program::run(int argc, char** argv) {
    const std::string program = app_->get_name();
    try {
        const int code = parse_and_trace(*app_, argc, argv, common_.trace);
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

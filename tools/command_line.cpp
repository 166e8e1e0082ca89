#include "tools/command_line.h"

#include <CLI/CLI.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/trace_file.h"
#include "gpu/debug_buffer.h"
#include "stream/transport/transfer_watch.h"
#include "tools/commands.h"
#include "tools/help_text.h"
#include "tools/remedies.h"
#include "tools/results.h"
#include "tools/say.h"

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

std::vector<std::string> option_names(const CLI::App& verb) {
    std::vector<std::string> names;
    for (const CLI::App* app = &verb; app; app = app->get_parent()) {
        for (const CLI::Option* option : app->get_options())
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const CLI::App* group : app->get_subcommands([](const CLI::App* one) { return one->get_name().empty(); }))
            for (const CLI::Option* option : group->get_options())
                for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

std::string guess(const std::string& typed, const std::vector<std::string>& names) {
    const std::string nearest = nearest_name(typed, names);
    return nearest.empty() ? "" : fmt::format("; did you mean `{}`?", nearest);
}

// What is wrong where a verb is missing or not known.
std::string verb_problem(const CLI::App& verb, const std::string& path, const std::string& typed) {
    std::vector<std::string> names;
    for (const CLI::App* choice : verbs_of(verb)) names.push_back(choice->get_name());
    if (typed.empty()) return fmt::format("`{}` needs a verb: {}", path, fmt::join(names, ", "));
    const std::string meant = guess(typed, names);
    return fmt::format("there is no `{} {}`{}", path, typed,
                       meant.empty() ? fmt::format("; choose from {}", fmt::join(names, ", ")) : meant);
}

// One line that says what is wrong and which --help shows how it is done.
std::string usage_error(const CLI::App* app, const CLI::Error& error) {
    const auto [verb, path] = named_verb(app);
    const std::string whole = app->get_name() + (path.empty() ? "" : " " + path);
    std::string problem = error.what();
    const auto unknown = app->remaining(true);
    const std::string typed = unknown.empty() ? "" : unknown[0];
    const bool is_option = typed.size() > 1 && typed[0] == '-';
    if (is_option)
        problem = fmt::format("`{}` has no option {}{}", whole, typed,
                              guess(typed.substr(0, typed.find('=')), option_names(*verb)));
    else if (!verbs_of(*verb).empty() && (!typed.empty() || problem.find("subcommand") != std::string::npos))
        problem = verb_problem(*verb, whole, typed);
    else if (!typed.empty())
        problem = fmt::format("`{}` takes no further \"{}\"", whole, typed);
    for (char& c : problem)
        if (c == '\n' || c == '\r') c = ' ';
    return fmt::format("{}: {}; `{} --help` shows how\n", app->get_name(), problem, whole);
}

// Help of at most kHelpColumns columns.
class HelpFormatter : public CLI::Formatter {
    static constexpr size_t kOptionColumn = 32, kVerbColumn = 14;

  public:
    std::string make_option(const CLI::Option* option, bool is_positional) const override {
        const std::string name = make_option_name(option, is_positional) + make_option_opts(option);
        return help_entry(name, make_option_desc(option), kOptionColumn);
    }
    std::string make_subcommand(const CLI::App* verb) const override {
        return help_entry(verb->get_name(), verb->get_description(), kVerbColumn);
    }
    std::string make_description(const CLI::App* app) const override {
        return filled(CLI::Formatter::make_description(app));
    }
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return filled("  " + CLI::Formatter::make_usage(app, std::move(name))).substr(2);
    }
    std::string make_footer(const CLI::App* app) const override {
        std::string text = app->get_footer();
        text = filled(text.erase(0, text.find_first_not_of('\n')));
        if (app->get_parent()) text += kOptionsOfAll;
        return text;
    }

  private:
    static constexpr const char* kOptionsOfAll =
        "\nOptions of every verb: --device, --overwrite, --trace (`neuvv --help` tells what they are).\n";
};

// All that the user gave as values of options, of this verb and of those below it.
void add_given(const CLI::App& app, std::vector<GivenPath>& given) {
    for (const CLI::Option* option : app.get_options())
        for (const std::string& value : option->count() > 0 ? option->results() : std::vector<std::string>())
            given.push_back({option->get_name(), value});
    for (const CLI::App* below :
         app.get_subcommands([](const CLI::App* one) { return one->get_name().empty() || one->count() > 0; }))
        add_given(*below, given);
}

// Throws InputError where the words are no verb, nor one of that verb.
void expect_verb(const CLI::App& program, const std::vector<std::string>& words) {
    const CLI::App* app = &program;
    std::string path = program.get_name();
    for (const std::string& word : words) {
        const auto below = verbs_of(*app);
        const auto found = std::ranges::find(below, word, [](const CLI::App* verb) { return verb->get_name(); });
        if (found == below.end()) throw InputError("help", "", verb_problem(*app, path, word));
        app = *found;
        path += " " + word;
    }
}

// The command line in CLI11's words: `help VERB` is `VERB --help`, nothing is `--help`, and `--option=` is an option
// with an empty value, for which CLI11 would take the next word.
std::vector<std::string> words_of(const CLI::App& program, int argc, char** argv) {
    std::vector<std::string> words;
    bool only_values = false;  // behind `--`
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        only_values |= word == "--";
        const bool is_empty = !only_values && word.size() > 3 && word.starts_with("--") && word.ends_with('=') &&
                              word.find('=') == word.size() - 1;
        words.push_back(is_empty ? word.substr(0, word.size() - 1) : word);
        if (is_empty) words.emplace_back();
    }
    const bool asks = !words.empty() && words[0] == "help";
    if (asks) words.erase(words.begin());
    if (asks) expect_verb(program, words);
    if (asks || words.empty()) words.emplace_back("--help");
    return words;
}

int parse(CLI::App& app, int argc, char** argv) {
    std::vector<std::string> words = words_of(app, argc, argv);
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    try {
        app.parse(std::move(words));
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
    return Option(option_->check(CLI::Validator(
        [](const std::string& text) {
            return std::filesystem::is_directory(text) ? std::string()
                                                       : fmt::format("{}: there is no such folder", text);
        },
        "FOLDER")));
}

Command Command::add_verb(const std::string& name, const std::string& description) const {
    return Command(command_->add_subcommand(name, description));
}

void Command::group_verbs(const std::string& title, std::initializer_list<const char*> names) const {
    for (const char* name : names) command_->get_subcommand(name)->group(title);
}

Command Command::add_group(const std::string& title) const {
    return Command(command_->add_option_group(title));
}

template <typename Value>
Option Command::add_option(const std::string& name, Value& value, const std::string& description) const {
    CLI::Option* option = command_->add_option(name, value, description);
    option->check([](const std::string& text) { return std::string(text.empty() ? "has no value" : ""); });
    return Option(option);
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

Program::Program(const std::string& name, const std::string& description, const std::string& version,
                 CommonOptions& common)
    : app_(std::make_unique<CLI::App>(description, name)), common_(common) {
    open_standard_streams();
    gpu::set_shader_message_sink([](const std::string& line) { say("shader: {}\n", line); });
    stream::set_waiting_sink([](const std::string& line) { say("{}\n", line); });
    app_->require_subcommand(1);
    app_->failure_message(usage_error);
    app_->formatter(std::make_shared<HelpFormatter>());
    app_->set_version_flag("--version", fmt::format("{} {}", name, version));
    app_->add_option("--device", common.device, "Vulkan device: an index or part of a name (see `neuvv devices`)")
        ->envname("NEUVV_DEVICE");
    app_->add_flag("--overwrite", common.overwrite,
                   "Replace results that are there, each once the new one is whole; without it, a verb that would do "
                   "so ends before it begins");
    app_->add_option("--trace", common.trace,
                     "Write what threads and the device did when, for https://ui.perfetto.dev, to this .json");
    // Options are parsed before verbs run.
    app_->parse_complete_callback([this, &common] {
        GivenPaths given{{}, common.overwrite};
        add_given(*app_, given.paths);
        set_given_paths(std::move(given));
        if (common.trace.empty()) return;
        prepare_result("--trace", common.trace, kJsonEnding);
        name_trace_thread("main thread");
        begin_trace();
    });
    app_->fallthrough();
}

Program::~Program() = default;

int Program::run(int argc, char** argv) {
    const int code = run_verb(argc, argv);
    if (code != 0) remove_empty_output_folders();
    return code;
}

int Program::run_verb(int argc, char** argv) {
    const std::string program = app_->get_name();
    try {
        const int code = parse_and_trace(*app_, argc, argv, common_.trace);
        if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
        say("{}: the results could not be written to the standard output\n", program);
        return kFailure;
    } catch (const InputError& error) {
        say("{}: {}\n", program, message_of(error));
        return kBadInput;
    } catch (const std::exception& error) {
        say("{}: {}\n", program, message_of(error));
        return kFailure;
    }
}

}  // namespace neuvv::tools

// What the programs neuvv and neuvv-bench share: how they run a verb, and the options that several verbs have. At the
// end: the verbs of neuvv, each of which adds its subcommand with options, help and callback.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace neuvv::tools {

// Options that every verb has.
struct CommonOptions {
    std::string device;  // index or part of a name; empty: NEUVV_DEVICE, else the best
};

// Sets the options, the version and the error message that both programs have. The name of `app` is the program's.
void set_up_program(CLI::App& app, CommonOptions& common);

// Parses the command line, which runs the verb that it names, and returns the exit code: 0, 1 for a failure of the
// machine, 2 for bad input. An error is one line on stderr.
int run_program(CLI::App& app, int argc, char** argv);

// Like CLI::Range, but refuses NaN.
CLI::Validator number_between(double low, double high);

// An option whose value is `on` or `off`; nothing where the user does not give it.
CLI::Option* add_switch(CLI::App& verb, const std::string& name, std::optional<bool>& value, const std::string& help);

// An option whose value is one of `names`, which are in the order of the enumeration.
template <typename Enum>
CLI::Option* add_choice(CLI::App& verb, const std::string& name, std::optional<Enum>& value,
                        std::span<const char* const> names, const std::string& help) {
    const auto choose = [&value, names](const std::string& text) {
        value = static_cast<Enum>(std::find(names.begin(), names.end(), text) - names.begin());
    };
    return verb.add_option_function<std::string>(name, choose, help)
        ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
}

// --samples, for the verbs that render: rays a pixel along each side.
constexpr uint32_t kDefaultSamples = 2;
CLI::Option* add_samples_option(CLI::App& verb, uint32_t& samples);

// --slice-budget, for the verbs that play.
void add_slice_budget_option(CLI::App& verb, double& mebibytes);
inline uint64_t bytes_of_mebibytes(double mebibytes) {
    return static_cast<uint64_t>(mebibytes * 1048576);
}

// --format, for the verbs that read data sets.
void add_format_option(CLI::App& verb, std::string& format);

void add_devices(CLI::App& app, CommonOptions& common);
void add_info(CLI::App& app, CommonOptions& common);
void add_capture(CLI::App& app, CommonOptions& common);
void add_dataset(CLI::App& app, CommonOptions& common);
void add_matte(CLI::App& app, CommonOptions& common);
void add_train(CLI::App& app, CommonOptions& common);
void add_eval(CLI::App& app, CommonOptions& common);
void add_convert(CLI::App& app, CommonOptions& common);
void add_render(CLI::App& app, CommonOptions& common);
void add_stage(CLI::App& app, CommonOptions& common);
void add_paint(CLI::App& app, CommonOptions& common);
void add_view(CLI::App& app, CommonOptions& common);
void add_xr(CLI::App& app, CommonOptions& common);

}  // namespace neuvv::tools

// The verbs of the program: each adds its subcommand with options, help and callback. Only this folder prints.
#pragma once

#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <string>

#include "training/formats.h"

namespace neuvv::tools {

// Options that every verb shares.
struct CommonOptions {
    std::string device;  // index or part of a name; empty: NEUVV_DEVICE, else the best
};

// CLI::Range, but NaN is no number between anything.
inline CLI::Validator number_between(double low, double high) {
    return CLI::Validator(
        [low, high](const std::string& text) {
            double value = 0;
            const bool number = CLI::detail::lexical_cast(text, value);
            if (number && value >= low && value <= high) return std::string();
            return fmt::format("{} is no number from {} to {}", text, low, high);
        },
        fmt::format("[{} - {}]", low, high));
}

// --samples, for the verbs that render: rays a pixel along each side.
constexpr uint32_t kDefaultSamples = 2;
inline CLI::Option* add_samples_option(CLI::App& verb, uint32_t& samples) {
    return verb
        .add_option("--samples", samples, "Rays a pixel along each side: 2 averages 4 of them, for smooth edges")
        ->check(CLI::Range(1, 4))
        ->capture_default_str();
}

// --slice-budget, for the verbs that play.
inline void add_slice_budget_option(CLI::App& verb, double& megabytes) {
    verb.add_option("--slice-budget", megabytes,
                    "MiB on the device for frames' slices that are kept, however many instances there are; 0: no "
                    "slices, all numbers at each sample (slow)")
        ->check(number_between(0, 1048576))
        ->capture_default_str();
}

// --format, for the verbs that read data sets.
inline void add_format_option(CLI::App& verb, std::string& format) {
    verb.add_option("--format", format, "The data set's layout; auto: by the files in it")
        ->check(CLI::IsMember(training::format_names()))
        ->capture_default_str();
}

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

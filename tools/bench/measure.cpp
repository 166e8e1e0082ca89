#include "tools/bench/measure.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/platform.h"
#include "tools/report.h"

namespace neuvv::bench {

CLI::App* add_verb(CLI::App& app, const VerbHelp& help, BenchOptions& options) {
    CLI::App* verb = app.add_subcommand(help.name, help.summary);
    verb->add_option("scene", options.scene, help.scene)->required();
    std::string footer = help.explanation + tools::kDeviceHelp + tools::kExamplesHead;
    for (const std::string& example : help.examples)
        footer += fmt::format("{}  neuvv-bench {} {}", footer.ends_with('\n') ? "" : "\n", help.name, example);
    verb->footer(footer);
    return verb;
}

void add_size_option(CLI::App& verb, BenchOptions& options, const char* help) {
    verb.add_option("--size", options.size, help)->capture_default_str();
}

void add_views_option(CLI::App& verb, BenchOptions& options) {
    verb.add_option("--views", options.views, "Views of the orbit, as the clip plays")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
}

void add_repeats_option(CLI::App& verb, BenchOptions& options, const char* help) {
    verb.add_option("--repeats", options.repeats, help)->check(CLI::Range(1, 10000))->capture_default_str();
}

void add_image_option(CLI::App& verb, BenchOptions& options) {
    verb.add_option("--picture", options.image, "Write what was drawn to this PNG");
}

void add_json_flag(CLI::App& verb, BenchOptions& options) {
    verb.add_flag("--json", options.json, "Print JSON");
}

double quantile(std::vector<double> values, double p) {
    if (values.empty()) return 0;
    const auto at = std::min(values.size() - 1, static_cast<size_t>(p * static_cast<double>(values.size())));
    std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(at), values.end());
    return values[at];
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

void expect_not_stopped() {
    if (stop_requested()) throw RuntimeFailure("stopped before the end");
}

double copy_milliseconds(const gpu::Device& device, const gpu::Buffer& from, const gpu::Buffer& to) {
    gpu::Commands commands(device, "copy");
    commands.begin();
    {
        const gpu::PassScope scope(commands, "copy");
        gpu::copy(commands, from, to, from.bytes);
    }
    commands.submit();
    commands.wait();
    return commands.pass_times()[0].milliseconds;
}

double copied_bytes_per_second(const gpu::Device& device, const render::Field& field) {
    const gpu::Buffer copied(device, "copy", field.weights.bytes, gpu::MemoryKind::kDevice);
    std::vector<double> copies;
    for (int i = 0; i < 5; i++) copies.push_back(copy_milliseconds(device, field.weights, copied));
    return 2000 * static_cast<double>(field.weights.bytes) / median(copies);
}

double milliseconds(const std::vector<gpu::PassTime>& passes) {
    double sum = 0;
    for (const gpu::PassTime& pass : passes) sum += pass.milliseconds;
    return sum;
}

void add_image(std::vector<PassSum>& sums, const std::vector<gpu::PassTime>& passes) {
    for (const gpu::PassTime& pass : passes) {
        auto found = std::find_if(sums.begin(), sums.end(), [&](const PassSum& sum) { return sum.name == pass.name; });
        if (found == sums.end()) found = sums.insert(sums.end(), {pass.name, {}});
        const bool again = std::find_if(passes.data(), &pass, [&](const gpu::PassTime& earlier) {
                               return earlier.name == pass.name;
                           }) != &pass;
        if (again)
            found->ms.back() += pass.milliseconds;
        else
            found->ms.push_back(pass.milliseconds);
    }
}

std::string passes_text(const std::vector<PassSum>& sums) {
    std::string text;
    for (const PassSum& sum : sums)
        text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", sum.name, median(sum.ms));
    return text;
}

}  // namespace neuvv::bench

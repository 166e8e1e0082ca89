// What the measurements of neuvv-bench share.
#pragma once

#include <vector>

#include "render/field.h"
#include "render/slice_cache.h"
#include "tools/commands.h"

namespace neuvv::bench {

// What a measurement may be asked for. Each verb has those of the options that it adds.
struct BenchOptions {
    std::string scene, size = "1280x720", image;
    uint32_t views = 4, repeats = 5;
    double slice_budget_mb = static_cast<double>(render::kSliceBudget >> 20);
    bool json = false;
};

struct VerbHelp {
    const char *name, *summary;
    std::string explanation;            // of what is measured
    std::vector<std::string> examples;  // what stands behind `neuvv-bench`
    const char* scene = "The .nvv file";
};

// Adds a verb with its scene and its help.
CLI::App* add_verb(CLI::App& app, const VerbHelp& help, BenchOptions& options);
void add_size_option(CLI::App& verb, BenchOptions& options, const char* help = "WIDTHxHEIGHT");
void add_views_option(CLI::App& verb, BenchOptions& options);
void add_repeats_option(CLI::App& verb, BenchOptions& options, const char* help);
void add_image_option(CLI::App& verb, BenchOptions& options);
void add_json_flag(CLI::App& verb, BenchOptions& options);

// The value that a share `p` of the values does not exceed; 0 of none.
double quantile(std::vector<double> values, double p);
// Throws RuntimeFailure where the user has asked to stop.
void expect_not_stopped();
// How long the device takes to copy all of a buffer to another: the measure of what its memory gives.
double copy_milliseconds(const gpu::Device& device, const gpu::Buffer& from, const gpu::Buffer& to);
// Bytes read and written in a second by a copy of the field's weights, as the median of some copies.
double copied_bytes_per_second(const gpu::Device& device, const render::Field& field);
// Of all passes together.
double milliseconds(const std::vector<gpu::PassTime>& passes);
double mean(const std::vector<double>& values);  // 0 of none
inline double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

// What each pass took in every image, by name in the order of the first.
struct PassSum {
    std::string name;
    std::vector<double> ms;  // one an image, however often the pass ran in it
};
void add_image(std::vector<PassSum>& sums, const std::vector<gpu::PassTime>& passes);
// "shade 1.2 trace 3.4": medians.
std::string passes_text(const std::vector<PassSum>& sums);

}  // namespace neuvv::bench

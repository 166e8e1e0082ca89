// What the measurements of `neuvv bench` share.
#pragma once

#include <vector>

#include "gpu/buffer.h"
#include "tools/commands.h"

namespace neuvv {

void add_bench_train(CLI::App& bench, CommonOptions& common);
void add_bench_open(CLI::App& bench, CommonOptions& common);
void add_bench_render(CLI::App& bench, CommonOptions& common);
void add_bench_slice(CLI::App& bench, CommonOptions& common);

// The value that a share `p` of the values does not exceed; 0 of none.
double quantile(std::vector<double> values, double p);
// How long the device takes to copy all of a buffer to another: the measure of what its memory gives.
double copy_milliseconds(const Device& device, const Buffer& from, const Buffer& to);
inline double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

}  // namespace neuvv

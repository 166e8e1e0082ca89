// What the measurements of neuvv-bench share.
#pragma once

#include <vector>

#include "gpu/commands.h"
#include "tools/commands.h"

namespace neuvv::bench {

// The value that a share `p` of the values does not exceed; 0 of none.
double quantile(std::vector<double> values, double p);
// Throws RuntimeFailure where the user has asked to stop.
void expect_not_stopped();
// How long the device takes to copy all of a buffer to another: the measure of what its memory gives.
double copy_milliseconds(const gpu::Device& device, const gpu::Buffer& from, const gpu::Buffer& to);
double mean(const std::vector<double>& values);  // 0 of none
inline double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

// What each pass took in every picture, by name in the order of the first.
struct PassSum {
    std::string name;
    std::vector<double> ms;  // one a picture, however often the pass ran in it
};
void add_picture(std::vector<PassSum>& sums, const std::vector<gpu::PassTime>& passes);
// "shade 1.2 trace 3.4": medians.
std::string passes_text(const std::vector<PassSum>& sums);

}  // namespace neuvv::bench

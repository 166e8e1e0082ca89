#include "tools/bench/measure.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/platform.h"
#include "gpu/commands.h"

namespace neuvv::bench {

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

void add_picture(std::vector<PassSum>& sums, const std::vector<gpu::PassTime>& passes) {
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

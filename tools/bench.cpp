// neuvv bench: how fast passes run on a device, as medians over repeats and ratios within one run.
#include "tools/bench.h"

#include <algorithm>

#include "gpu/commands.h"

namespace neuvv {

double quantile(std::vector<double> values, double p) {
    if (values.empty()) return 0;
    const auto at = std::min(values.size() - 1, static_cast<size_t>(p * static_cast<double>(values.size())));
    std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(at), values.end());
    return values[at];
}

double copy_milliseconds(const Device& device, const Buffer& from, const Buffer& to) {
    Commands commands(device, "copy");
    commands.begin();
    {
        const PassScope scope(commands, "copy");
        copy(commands, from, to, from.bytes);
    }
    commands.submit();
    commands.wait();
    return commands.pass_times()[0].milliseconds;
}

void add_bench(CLI::App& app, CommonOptions& common) {
    CLI::App* verb = app.add_subcommand("bench", "Measure how fast passes run on a device");
    verb->require_subcommand(1);
    add_bench_open(*verb, common);
    add_bench_render(*verb, common);
    add_bench_slice(*verb, common);
    add_bench_train(*verb, common);
}

}  // namespace neuvv

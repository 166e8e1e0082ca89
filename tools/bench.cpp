// neuvv bench: how fast passes run on a device, as medians over repeats and ratios within one run.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "base/error.h"
#include "tools/commands.h"
#include "tools/report.h"
#include "training/schedule.h"
#include "training/step.h"
#include "voctree/nvv.h"

namespace neuvv {

namespace {

struct BenchTrainOptions {
    std::string scene, dataset;
    uint32_t tiles = 512, repeats = 30;
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

void run_train(const BenchTrainOptions& options, const CommonOptions& common) {
    const VOctree tree = read_nvv(options.scene);
    const Dataset dataset = load_dataset(options.dataset, Split::kTrain);
    const Device device(common.device);
    TrainingStep step(device, tree, static_cast<uint32_t>(dataset.cameras.size()), options.tiles);
    BatchSampler sampler(dataset, options.tiles, 1);
    std::vector<std::string> names;
    std::vector<double> slots;
    std::map<std::string, std::vector<double>> times;
    for (uint32_t i = 0; i <= options.repeats; i++) {
        const Batch batch = sampler.next();
        load_batch(dataset, batch, step.rays(), step.batch());
        StepSettings settings;
        settings.frame = static_cast<float>(frame_of_time(batch.time, tree.frames));
        settings.tiles = static_cast<uint32_t>(batch.tiles.size());
        settings.stop = kTrainingStop;
        settings.adam.step = i + 1;
        step.submit(settings);
        const StepResult result = step.wait();
        if (result.overflow > 0)
            throw RuntimeFailure(
                fmt::format("{} live leaves found no slot on this device: the scene is too large to train "
                            "on it",
                            result.overflow));
        if (i == 0) continue;  // the first step also warms caches
        slots.push_back(result.slots);
        names.clear();
        for (const PassTime& pass : step.pass_times()) {
            times[pass.name].push_back(pass.milliseconds);
            names.push_back(pass.name);
        }
    }
    fmt::print("{:.0f} live leaves of {}\n", median(slots), tree.leaf_count);
    for (const std::string& name : names) fmt::print("{:<16} {:>9.2f} ms\n", name, median(times[name]));
}

}  // namespace

void add_bench(CLI::App& app, CommonOptions& common) {
    CLI::App* verb = app.add_subcommand("bench", "Measure how fast passes run on a device");
    verb->require_subcommand(1);
    CLI::App* training = verb->add_subcommand("train", "A training step, pass by pass");
    const auto options = std::make_shared<BenchTrainOptions>();
    training->add_option("scene", options->scene, "The .nvv file")->required();
    training->add_option("dataset", options->dataset, "The data set's folder")->required();
    training->add_option("--tiles", options->tiles, "Tiles of 8x8 rays a step")->check(CLI::Range(1, 65536));
    training->add_option("--repeats", options->repeats, "Steps that the medians are over")->check(CLI::Range(1, 10000));
    training->footer(std::string("Runs steps of training on the scene as it is, and prints the median GPU time of each "
                                 "pass; weights in the\n"
                                 "file stay as they are. ") +
                     kDeviceHelp + kExamplesHead +
                     "  neuvv bench train build/performer.nvv build/performer --repeats 50");
    training->callback([options, &common] { run_train(*options, common); });
}

}  // namespace neuvv

// neuvv-bench train: the time of each pass of a training step, compared with direct gradients in the same run.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "tools/bench/measure.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/report.h"
#include "training/data/layouts/formats.h"
#include "training/run/schedule.h"
#include "training/run/train.h"
#include "training/step/direct_step.h"
#include "voctree/files/nvv.h"

namespace neuvv::bench {

namespace {

struct TrainOptions : BenchOptions {
    TrainOptions() { repeats = 30; }
    std::string dataset, format = training::kAnyFormat;
    uint32_t tiles = 512;
};

// Milliseconds of a pass per step, where a pass that only some steps have counts in proportion; 0 where no step has it.
double step_ms(const std::vector<PassSum>& passes, const std::string& name) {
    size_t steps = 0, with_pass = 0;
    double ms = 0;
    for (const PassSum& pass : passes) {
        steps = std::max(steps, pass.ms.size());
        if (pass.name == name) with_pass = pass.ms.size(), ms = median(pass.ms);
    }
    return steps > 0 ? ms * static_cast<double>(with_pass) / static_cast<double>(steps) : 0;
}

struct TrainResult {
    std::vector<PassSum> slice, direct;
    uint32_t busy_planes = 0;
    std::vector<double> slots, touched, rays, step_seconds;
    double copy_bytes_per_s = 0;
};

// Runs the same batches through both kinds of step, with the same weights.
TrainResult measure(const gpu::Device& device, const voctree::VOctree& tree, const training::Dataset& dataset,
                    const TrainOptions& options) {
    const auto cameras = static_cast<uint32_t>(dataset.cameras.size());
    training::TrainingStep step(device, tree, cameras, options.tiles);
    std::optional<training::DirectStep> direct;
    if (step.field().whole_weights().bytes <= device.limits().maxStorageBufferRange)
        direct.emplace(device, tree, cameras, options.tiles, training::best_atomic_add(device));
    training::BatchSampler sampler(dataset, options.tiles, 1, training::batches_in_a_row(tree));
    TrainResult result;
    result.busy_planes = step.field().busy_planes;
    tools::Progress progress("bench", options.repeats);
    for (uint32_t i = 0; i <= options.repeats && !stop_requested(); ++i) {
        const training::Batch batch = sampler.next();
        training::StepSettings settings;  // learning rates are 0, so weights stay as they are
        settings.frame = static_cast<float>(training::frame_of_time(batch.time, tree.frames));
        settings.tiles = static_cast<uint32_t>(batch.tiles.size());
        settings.stop = training::kTrainingStop;
        settings.adam.step = i + 1;
        settings.learn_rows = tree.bases < tree.frames && i % training::kStepsPerRows == 0;
        settings.weights.smoothness = training::kDefaultLossWeights.smoothness;
        training::load_batch(dataset, batch, step.rays(), step.batch());
        const double start = seconds_now();
        step.submit(settings);
        const training::StepResult step_result = step.wait();
        const double took = seconds_now() - start;
        if (step_result.overflow > 0)
            throw RuntimeFailure(
                fmt::format("{} live leaves found no slot on this device: the scene is too large to train on it",
                            step_result.overflow));
        if (direct) {
            training::load_batch(dataset, batch, direct->rays(), direct->batch());
            direct->run(settings);
        }
        if (i == 0) continue;  // the first step also warms caches
        add_image(result.slice, step.pass_times());
        if (direct) add_image(result.direct, direct->pass_times());
        result.slots.push_back(step_result.slots);
        result.touched.push_back(step_result.touched);
        result.rays.push_back(static_cast<double>(step_result.pixels));
        result.step_seconds.push_back(took);
        progress.update(i);
    }
    result.copy_bytes_per_s = copied_bytes_per_second(device);
    return result;
}

// Bytes that the slice's adjoint moves: it reads and writes weights and both moments of each plane with a gradient,
// reads the weights once more for the slice that it updates, reads and clears the slot's gradient, and writes its σ and
// SH.
double optimiser_bytes(uint32_t busy_planes, uint32_t hh_degree, double touched) {
    const double planes = 2.0 * busy_planes + hh_count(hh_degree);
    return touched * (112 * planes + 8.0 * gradient_stride(hh_degree) + 8 + 16.0 * sh_count(hh_degree));
}

void print_passes(const std::vector<PassSum>& passes) {
    for (const PassSum& pass : passes)
        fmt::print("  {:<16} {:>9} ms\n", pass.name, ms_text(step_ms(passes, pass.name)));
}

// Compares slice-space with direct gradients.
void print_ratio(const TrainResult& result, uint32_t numbers) {
    if (result.direct.empty()) {
        fmt::print("direct gradients: this device binds no buffer as large as the weights of so many leaves\n");
        return;
    }
    fmt::print("direct gradients, {} numbers a sample\n", numbers);
    print_passes(result.direct);
    const auto sum = [](const std::vector<PassSum>& passes, std::initializer_list<const char*> names) {
        double total = 0;
        for (const char* name : names) total += step_ms(passes, name);
        return total;
    };
    fmt::print("scattering gradients from rays: slice-space {:.1f} times as fast as direct\n",
               sum(result.direct, {"direct adjoint"}) / sum(result.slice, {"trace adjoint"}));
    fmt::print("forwards and backwards: {:.1f} times as fast (slice-space with the optimiser, direct without)\n",
               sum(result.direct, {"direct", "direct adjoint"}) /
                   sum(result.slice, {"slice", "trace", "trace adjoint", "touched", "slice adjoint"}));
}

double rays_per_s(const TrainResult& result) {
    return median(result.rays) / median(result.step_seconds);
}

// What the slice's adjoint and the optimiser in it move a second.
double optimiser_gb_s(const TrainResult& result, uint32_t hh_degree) {
    return optimiser_bytes(result.busy_planes, hh_degree, median(result.touched)) /
           step_ms(result.slice, "slice adjoint") / 1e6;
}

void print(const TrainResult& result, const gpu::Device& device, const voctree::VOctree& tree) {
    fmt::print("{}: {:.0f} rays a step, {:.0f} live leaves of {}, {:.0f} touched\n", device.summary().name,
               median(result.rays), median(result.slots), tree.leaf_count, median(result.touched));
    fmt::print("slice-space gradients, {} numbers a sample\n", gradient_stride(tree.hh_degree));
    print_passes(result.slice);
    print_ratio(result, 8 * result.busy_planes + 3 * hh_count(tree.hh_degree));
    fmt::print("training: {:.0f}k rays/s, {:.2f} Mrays/s for each TB/s of a copy\n", rays_per_s(result) / 1000,
               rays_per_s(result) / 1e6 / (result.copy_bytes_per_s / 1e12));
    const double copied = result.copy_bytes_per_s / 1e9, optimised = optimiser_gb_s(result, tree.hh_degree);
    fmt::print("slice adjoint and optimiser: {:.1f} GB/s, {:.0f} % of a copy's {:.1f} GB/s\n", optimised,
               100 * optimised / copied, copied);
}

nlohmann::ordered_json json_of(const TrainResult& result, const voctree::VOctree& tree) {
    return {{"rays", median(result.rays)},
            {"live_leaves", median(result.slots)},
            {"touched", median(result.touched)},
            {"mrays_per_second", rays_per_s(result) / 1e6},
            {"optimiser_gb_s", optimiser_gb_s(result, tree.hh_degree)},
            {"copy_gb_s", result.copy_bytes_per_s / 1e9},
            {"passes_ms", passes_json(result.slice)},
            {"direct_passes_ms", passes_json(result.direct)}};
}

void run_train(const TrainOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::VOctree tree = voctree::read_nvv(options.scene);
    const training::Dataset dataset =
        training::load_dataset(options.dataset, training::Split::kTrain, {.format = options.format});
    const gpu::Device device(common.device);
    const TrainResult result = measure(device, tree, dataset, options);
    if (result.slots.empty()) return;
    report(options, device, json_of(result, tree), [&] { print(result, device, tree); });
}

}  // namespace

void add_train(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] =
        add_verb(app, common,
                 {"train",
                  "A training step, pass by pass",
                  "Runs steps of training on the scene as it is, each also the paper's way (every number of "
                  "a leaf at every sample),\n"
                  "and prints the median GPU time of each pass, their ratio, and the share of the device's "
                  "bandwidth that the\n"
                  "optimiser reaches. Weights stay as they are. ",
                  {"work/performer.nvv work/performer --repeats 50"},
                  "The .nvv"},
                 run_train);
    verb.add_option("dataset", options.dataset, "The data set's folder").required();
    tools::add_format_option(verb, options.format);
    verb.add_option("--tiles", options.tiles, "Tiles of 8x8 rays a step").in_range(1, 65536);
    add_repeats_option(verb, options, "Steps that the medians are over");
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

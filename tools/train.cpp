// neuvv train: trains a volumetric video from a data set.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "tools/commands.h"
#include "tools/options.h"
#include "tools/refine.h"
#include "tools/report.h"
#include "training/formats.h"
#include "training/images.h"
#include "training/metrics_log.h"
#include "training/preview.h"
#include "training/psi_tree.h"
#include "training/schedule.h"
#include "training/train.h"

namespace neuvv::tools {

namespace {

// What a training run shows of itself besides its status line: a preview image and a log of its numbers.
struct LiveOptions {
    std::filesystem::path preview;  // PNG; empty: none
    std::filesystem::path metrics;  // JSON Lines; empty: none
};

constexpr double kPreviewPeriod_s = 3, kPreviewShare = 0.05;  // at least; of the run's time, at most

void expect_extension(const char* option, const std::filesystem::path& file, const char* extension) {
    if (file.extension() != extension)
        throw InputError(option, file.string(), fmt::format("is no name of a {} file", extension),
                         fmt::format("write for instance run{}", extension));
    prepare_output_file(option, file);
}

training::Dataset load_preview_data(const training::Dataset& training, const training::LoadOptions& load) {
    try {
        return training::preview_dataset(training::load_dataset(training.folder, training::Split::kTest, load));
    } catch (const std::runtime_error& error) {
        fmt::print(stderr, "the preview shows a training image, as no held-out one can be read: {}\n", error.what());
        return training::preview_dataset(training);
    }
}

// Throws InputError where one of the files could not be written, or is not named as such a file.
void prepare_live_outputs(const LiveOptions& options) {
    if (!options.preview.empty()) expect_extension("--preview", options.preview, ".png");
    if (!options.metrics.empty()) expect_extension("--metrics", options.metrics, ".jsonl");
}

class LiveReport {
  public:
    // Loads a held-out image where a preview is wanted; of a data set without one, a training image.
    LiveReport(const gpu::Device& device, const training::Dataset& training, const training::LoadOptions& load,
               LiveOptions options)
        : device_(device), options_(std::move(options)) {
        if (!options_.preview.empty()) preview_data_ = load_preview_data(training, load);
    }

    // Call it with every report of the run. Previews take at most a twentieth of the time. A preview that fails, for
    // instance for want of device memory, or a line of the log, for want of disk, is the last, and the run goes on.
    void update(const training::TrainProgress& now) {
        write_preview_if_due(now);
        if (options_.metrics.empty()) return;
        try {
            if (!log_) log_.emplace(options_.metrics, now.began_at_step);
            log_->add(now, score_);
        } catch (const RuntimeFailure& failure) {  // a run is worth more than its log
            fmt::print(stderr, "\nno more metrics: {}\n", failure.what());
            options_.metrics.clear();
        }
    }

  private:
    void write_preview_if_due(const training::TrainProgress& now) {
        const double wait_s = std::max(kPreviewPeriod_s, preview_took_s_ / kPreviewShare);
        if (options_.preview.empty() || now.elapsed_s - previewed_at_s_ < wait_s) return;
        const double begin = seconds_now();
        try {
            const training::Quality quality =
                training::write_preview(device_, *now.field, preview_data_, options_.preview);
            score_ = training::PreviewScore{preview_data_.views[0].name, quality.psnr};
        } catch (const RuntimeFailure& failure) {
            fmt::print(stderr, "\nno more previews: {}\n", failure.what());
            options_.preview.clear();
        }
        preview_took_s_ = seconds_now() - begin;
        previewed_at_s_ = now.elapsed_s + preview_took_s_;
    }

    const gpu::Device& device_;
    LiveOptions options_;
    training::Dataset preview_data_;
    std::optional<training::MetricsLog> log_;
    std::optional<training::PreviewScore> score_;
    double previewed_at_s_ = -1e9, preview_took_s_ = 0;  // of the run
};

struct TrainOptions {
    std::filesystem::path dataset, output;
    std::string format = training::kAnyFormat;
    training::TrainSettings settings;
    double max_megabytes = 0, image_gigabytes = 0;
    bool uniform = false;
    LiveOptions live;
    std::string refine;
    std::string init = "hull";
    double psi_minutes = 2;
    uint64_t psi_steps = 0;
};

// Prints the status line where it is due, with NEUVV_TRACE the times of the step's passes behind it.
template <typename RunProgress>
void report_progress(StatusLine& line, const RunProgress& now, const std::string& text) {
    if (!line.is_due()) return;
    line.print(text);
    if (trace_wanted()) fmt::print(stderr, "step {}: {}\n", now.step, pass_times_text(now.passes));
}

std::string progress_text(const training::TrainProgress& now) {
    return fmt::format(
        "{} eta {} | {:.0f}k rays/s | loss {:.5f} | batch {:.2f} dB | {}k leaves, depth {} | {:.1f} GiB of memory",
        format_duration(now.elapsed_s), format_duration(now.eta_s), now.rays_per_s / 1000, now.loss, now.psnr,
        now.leaves / 1000, now.depth, static_cast<double>(peak_memory_bytes()) / double(1 << 30));
}

std::string progress_text(const training::PsiProgress& now) {
    return fmt::format("psi {} eta {} | {:.1f}k rays/s | loss {:.5f} | batch {:.2f} dB | step {}",
                       format_duration(now.elapsed_s), format_duration(now.eta_s), now.rays_per_s / 1000, now.loss,
                       now.psnr, now.step);
}

// The first tree, read off a network that is trained for it. Ctrl-C ends the training of the network; the run that
// follows then saves and ends, too.
voctree::VOctree train_psi_tree(const TrainOptions& options, const gpu::Device& device,
                                const training::Dataset& dataset) {
    training::PsiSettings settings = training::default_psi_settings(device);
    settings.seed = options.settings.seed;
    settings.minutes = options.psi_minutes;
    settings.steps = options.psi_steps;
    StatusLine line(true);
    voctree::VOctree tree = training::psi_tree(device, dataset, options.settings.shape, training::kLevelsAbovePixel,
                                               settings, [&](const training::PsiProgress& now) {
                                                   report_progress(line, now, progress_text(now));
                                                   return !stop_requested();
                                               });
    line.end();
    fmt::print(stderr, "psi: {} leaves\n", tree.leaf_count);
    return tree;
}

// Throws InputError, before any work is done, where the result could not be written.
void prepare_output(const std::filesystem::path& output) {
    if (output.extension() != ".nvv" || std::filesystem::is_directory(output))
        throw InputError("--output", output.string(), "is no name of an .nvv file", "write for instance scene.nvv");
    prepare_output_file("--output", output);
}

training::LoadOptions load_options(const TrainOptions& options) {
    const bool given = options.image_gigabytes > 0;
    return {.format = options.format,
            .memory_bytes = given ? static_cast<uint64_t>(1e9 * options.image_gigabytes) : training::image_budget()};
}

// Prints how many images there are before it reads them, and afterwards what they take and which mattes are doubtful.
training::Dataset load_images(const TrainOptions& options, const training::Rig& rig,
                              const training::LoadOptions& load) {
    const training::ImageCount count = training::image_count(rig);
    fmt::print(stderr, "{}: {} cameras, {} frames, {} images of {}x{} = {}\n", options.dataset.string(), count.cameras,
               count.frames, count.images, count.width, count.height, size_text(count.bytes));
    training::Dataset dataset = training::read_images(rig, load);
    const uint64_t on_disk = dataset.spool->bytes_on_disk();
    fmt::print(stderr, "the tiles with foreground are {}, budget {}{}\n", size_text(training::image_bytes(dataset)),
               size_text(load.memory_bytes),
               on_disk > 0 ? fmt::format(": {} are streamed from disk", size_text(on_disk)) : "");
    const std::vector<training::DoubtfulMatte> doubtful = training::ignore_doubtful_mattes(dataset);
    fmt::print(stderr, "{}", doubtful_mattes_text(dataset, doubtful));
    return dataset;
}

void run_train(const TrainOptions& options, const CommonOptions& common) {
    prepare_output(options.output);
    prepare_live_outputs(options.live);
    training::TrainSettings settings = options.settings;
    const Refine refine = refine_of(options.refine);
    settings.refine = refine.what.colour;
    if (refine.needs_search() && options.init == "psi")
        throw InputError("--refine", options.refine, "cannot be combined with --init psi, but for colours",
                         "leave out one of the two");
    catch_stop_signals();
    const gpu::Device device(common.device);
    fmt::print(stderr, "training on {}\n", device.summary().name);
    const training::LoadOptions load = load_options(options);
    const training::Rig rig = training::read_rig(options.dataset, training::Split::kTrain, options.format);
    training::Dataset dataset = load_images(options, rig, load);
    LiveReport live(device, dataset, load, options.live);
    settings.program = "NeuVV " NEUVV_VERSION;
    settings.adaptive = !options.uniform;
    settings.max_bytes = static_cast<uint64_t>(1e6 * options.max_megabytes);
    if (refine.needs_search() && !settings.resume && !correct_rig(device, dataset, refine, settings)) {
        fmt::print("interrupted while errors of the rig were searched for: nothing was written\n");
        return;
    }
    voctree::VOctree first_tree;
    if (options.init == "psi" && !settings.resume) {
        first_tree = train_psi_tree(options, device, dataset);
        settings.first_tree = &first_tree;
    }
    StatusLine line(true);
    const training::TrainProgress last =
        training::train(device, dataset, settings, options.output, [&](const training::TrainProgress& now) {
            report_progress(line, now, progress_text(now));
            live.update(now);
            return !stop_requested();
        });
    line.end();
    fmt::print("wrote {}: {} leaves after {} steps, {:.1f} epochs, {}\n", options.output.string(), last.leaves,
               last.step, last.epochs, format_duration(last.elapsed_s));
    print_corrections(last, rig.cameras);
    if (settings.resume && last.step == last.began_at_step)
        fmt::print("the run had spent its budget; more --minutes or --steps go on from there\n");
    if (stop_requested() && last.fraction < 1)
        fmt::print("interrupted; the same command with --resume goes on from here\n");
}

std::string weight_option(const training::NamedLossWeight& weight) {
    return std::string("--lambda-") + weight.name;
}

// Names the given options that a resumed run ignores, because it keeps its own values.
void warn_of_ignored_options(const Command& verb) {
    std::string given;
    std::vector<std::string> names{"--resolution", "--bases",   "--hh-degree", "--init",  "--max-leaves",
                                   "--max-memory", "--uniform", "--seed",      "--refine"};
    for (const training::NamedLossWeight& weight : training::kLossWeights) names.push_back(weight_option(weight));
    for (const std::string& name : names)
        if (verb.count(name) > 0) given += fmt::format("{}{}", given.empty() ? "" : ", ", name);
    if (!given.empty()) fmt::print(stderr, "--resume: the run keeps its own {}, whatever is given now\n", given);
}

}  // namespace

void add_train(Command app, CommonOptions& common) {
    auto options = std::make_shared<TrainOptions>();
    Command verb = app.add_verb("train", "Train a volumetric video from a calibrated multi-view video");
    verb.add_option("dataset", options->dataset, "The data set's folder (see training/README.md)").required();
    add_format_option(verb, options->format);
    verb.add_option("-o,--output", options->output, "The .nvv to write; it and its .state are replaced").required();
    Option minutes = verb.add_option("--minutes", options->settings.minutes, "Budget in wall time (default 20)")
                         .number_between(0.01, 1e5);
    verb.add_option("--steps", options->settings.steps, "Budget in steps").in_range(1u, 1000000000u).excludes(minutes);
    verb.add_option("--resolution", options->settings.shape.resolution,
                    "Finest leaves along the longest side (default: one a pixel at the scene's distance)")
        .in_range(8u, training::kMaxResolution);
    verb.add_option("--bases", options->settings.shape.bases, "C: temporal bases; no more than the clip has frames")
        .in_range(1u, kMaxBases)
        .show_default();
    verb.add_option("--hh-degree", options->settings.shape.hh_degree, "n_max of the hyperspherical harmonics")
        .in_range(0u, kMaxHhDegree)
        .show_default();
    verb.add_option("--init", options->init, "What the octree begins as: the visual hull, or read off a network")
        .one_of({"hull", "psi"})
        .show_default();
    Option psi_minutes = verb.add_option("--psi-minutes", options->psi_minutes,
                                         "The network's own budget, before that of the octree, with --init psi")
                             .number_between(0.01, 1e5)
                             .show_default();
    verb.add_option("--psi-steps", options->psi_steps, "The same in steps")
        .in_range(1u, 1000000000u)
        .excludes(psi_minutes);
    Option max_leaves = verb.add_option("--max-leaves", options->settings.max_leaves,
                                        "The tree never has more (default: what the device trains)")
                            .in_range(64u, voctree::kMaxLeaves);
    Option max_memory = verb.add_option("--max-memory", options->max_megabytes,
                                        "MB that the finished .nvv takes at most (default: any)")
                            .number_between(0.1, 1e6);
    verb.add_flag("--uniform", options->uniform, "Leaves stay of one size: no pruning, no division by the loss's pull")
        .excludes(max_leaves)
        .excludes(max_memory);
    for (const training::NamedLossWeight& named : training::kLossWeights)
        verb.add_option(weight_option(named), options->settings.weights.*named.weight, named.meaning)
            .number_between(0.0, 100.0)
            .show_default();
    verb.add_option(
        "--refine", options->refine,
        "What else is learnt, of the cameras, one or more after commas. colour: gains and white balance; "
        "exposure: of each image; vignetting: lenses that darken towards the corners; poses: corrections "
        "of poses and focal lengths; time: cameras that are late, not together with poses; auto, alone: those of "
        "these that are worth it. The last three begin with a search, of a fifth of --minutes at most "
        "(default: nothing)");
    verb.add_option("--image-memory", options->image_gigabytes,
                    "GB that images may take in memory; more are streamed from disk (default: half of what is free)")
        .number_between(1e-6, 1e6);
    verb.add_option("--seed", options->settings.seed, "Same seed, same batches").not_negative().show_default();
    verb.add_flag("--resume", options->settings.resume,
                  "Go on from OUTPUT.state; shape, bounds, losses, seed and --refine are the run's, --minutes or "
                  "--steps its whole budget");
    verb.add_option("--preview", options->live.preview,
                    "Keep this PNG showing a held-out image: truth, render, error; rewritten every few seconds");
    verb.add_option("--metrics", options->live.metrics,
                    "Append a line of JSON about once a second to this .jsonl file: step, loss, PSNR, leaves, ... "
                    "(see training/metrics_log.h); --resume continues it");
    verb.footer(
        {"Checkpoints replace OUTPUT during the run, so it can be watched, stopped with Ctrl-C and resumed.\n"
         "After Ctrl-C it saves, says that it was interrupted, and ends with exit code 0.\n"
         "NEUVV_TRACE=1 prints the time of each pass. ",
         kDeviceHelp,
         "\n\nExamples, after `neuvv capture tools/performer/performer.glb -o build/performer`:\n"
         "  neuvv train build/performer -o build/performer.nvv --minutes 20\n"
         "  neuvv train build/performer -o build/performer.nvv --minutes 40 --resume\n"
         "  neuvv train build/performer -o build/live.nvv --preview build/live.png --metrics build/live.jsonl\n"
         "  neuvv train build/performer -o build/psi.nvv --init psi --psi-minutes 10 --minutes 20\n"
         "  neuvv train build/performer -o build/rig.nvv --refine auto\n"
         "  neuvv train build/performer -o build/light.nvv --max-memory 20\n"
         "  neuvv train build/performer -o build/small.nvv --steps 500 --resolution 96 --bases 8"});
    verb.callback([options, verb, &common] {
        if (options->settings.resume) warn_of_ignored_options(verb);
        run_train(*options, common);
    });
}

}  // namespace neuvv::tools

#include "tools/train/train_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "base/text.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/train/refine.h"
#include "training/data/images.h"
#include "training/mattes/surroundings.h"
#include "training/psi/psi_tree.h"
#include "training/run/metrics_log.h"
#include "training/run/preview.h"
#include "training/run/schedule.h"
#include "voctree/files/nvv.h"
#include "voctree/temporal_basis.h"

namespace neuvv::tools {

namespace {

constexpr double kPreviewPeriod_s = 3, kPreviewShare = 0.05;  // at least; of the run's time, at most

// The image that previews show: of the first held-out camera, at the frames that are trained.
training::Dataset load_preview_data(const TrainOptions& options, const training::Dataset& training,
                                    const training::LoadOptions& load) {
    try {
        training::Rig rig = training::read_rig(training.folder, training::Split::kTest, load.format, load.holdout);
        if (options.frames) rig = options.frames->of(rig);
        if (rig.shots.empty())
            throw InputError(training.folder.string(), "", "has no held-out image of these frames",
                             "hold out a camera that has images at all times");
        const uint32_t camera = rig.shots[0].camera;
        std::erase_if(rig.shots, [&](const training::Shot& shot) { return shot.camera != camera; });
        training::drop_cameras_without_shots(rig);
        return training::preview_dataset(training::read_images(rig, load));
    } catch (const std::runtime_error& error) {
        say("the preview shows a training image, as no held-out one can be read: {}\n", message_of(error));
        return training::preview_dataset(training);
    }
}

class LiveReport {
  public:
    // Loads a held-out image where a preview is wanted; of a data set without one, a training image.
    LiveReport(const gpu::Device& device, const training::Dataset& training, const training::LoadOptions& load,
               const TrainOptions& options)
        : device_(device), options_(options.live) {
        if (options.frames) first_frame_ = options.frames->first;
        if (!options_.preview.empty()) preview_data_ = load_preview_data(options, training, load);
    }

    // Call it with every report of the run. Previews take at most a twentieth of the time. A preview that fails, for
    // instance for want of device memory, or a line of the log, for want of disk, is the last, and the run goes on.
    void update(const training::TrainProgress& now) {
        write_preview_if_due(now);
        if (options_.metrics.empty()) return;
        try {
            if (!log_) log_.emplace(options_.metrics, now.began_at_step, first_frame_);
            log_->add(now, score_);
        } catch (const std::runtime_error& failure) {  // a run is worth more than its log
            say("\nno more metrics: {}\n", message_of(failure));
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
            say("\nno more previews: {}\n", message_of(failure));
            options_.preview.clear();
        }
        preview_took_s_ = seconds_now() - begin;
        previewed_at_s_ = now.elapsed_s + preview_took_s_;
    }

    const gpu::Device& device_;
    LiveOptions options_;
    std::optional<uint32_t> first_frame_;
    training::Dataset preview_data_;
    std::optional<training::MetricsLog> log_;
    std::optional<training::PreviewScore> score_;
    double previewed_at_s_ = -1e9, preview_took_s_ = 0;  // of the run
};

// Prints the status line where it is due, with NEUVV_TRACE the times of the step's passes behind it.
template <typename RunProgress>
void report_progress(StatusLine& line, const RunProgress& now, const std::string& text) {
    if (!line.is_due()) return;
    line.print(text);
    if (trace_wanted()) say("step {}: {}\n", now.step, pass_times_text(now.passes));
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
    say("psi: {} leaves\n", tree.leaf_count);
    return tree;
}

training::LoadOptions load_options(const TrainOptions& options) {
    const bool given = options.image_gigabytes > 0;
    return {.format = options.format,
            .holdout = options.holdout,
            .mattes_needed = !options.surroundings,
            .may_be_empty = options.frames.has_value(),
            .memory_bytes = given ? static_cast<uint64_t>(1e9 * options.image_gigabytes) : training::image_budget()};
}

// Prints how many images there are before it reads them, and afterwards what they take and which mattes are doubtful.
training::Dataset load_images(const TrainOptions& options, const training::Rig& rig, const training::LoadOptions& load,
                              bool quiet) {
    const training::ImageCount count = training::image_count(rig);
    if (!quiet)
        say("{}: {} cameras, {} frames, {} images of {}x{} = {}\n", options.dataset.string(), count.cameras,
            count.frames, count.images, count.width, count.height, size_text(count.bytes));
    training::Dataset dataset = training::read_images(rig, load);
    const uint64_t on_disk = dataset.spool->bytes_on_disk();
    if (!quiet)
        say("the tiles with foreground are {}, budget {}{}\n", size_text(training::image_bytes(dataset)),
            size_text(load.memory_bytes),
            on_disk > 0 ? fmt::format(": {} are streamed from disk", size_text(on_disk)) : "");
    const std::vector<training::DoubtfulMatte> doubtful = training::ignore_doubtful_mattes(dataset);
    // Of processes that train one tree, one says it.
    if (!quiet || options.frames) say("{}", doubtful_mattes_text(dataset, doubtful));
    return dataset;
}

// So many pixels of an image's longer side are enough for leaves of surroundings.
uint32_t image_side(const TrainOptions& options) {
    const bool resumes = options.settings.resume;
    return resumes ? training::load_checkpoint(options.output).run.leaves_along_image
                   : training::resolution_around(options.settings.shape.resolution);
}

// Whether no image has foreground: of such images, no tile is kept.
bool shows_nothing(const training::Dataset& dataset) {
    return std::all_of(dataset.views.begin(), dataset.views.end(),
                       [](const training::View& view) { return view.image.kept_rgba().empty(); });
}

// A clip in whose frames nobody is.
void write_empty(const TrainOptions& options, const training::Dataset& dataset) {
    voctree::VOctree tree;
    tree.frames = static_cast<uint32_t>(dataset.times.size());
    tree.bases = 1;
    tree.hh_degree = options.settings.shape.hh_degree;
    if (dataset.fps > 0) tree.fps = static_cast<float>(dataset.fps);
    tree.sigma_basis = voctree::hat_basis(tree.frames, 1);
    tree.gamma_basis = tree.sigma_basis;
    voctree::build_topology(tree, {});
    const voctree::ChunkOfFrame chunk(dataset.frame);
    voctree::write_nvv(options.output, tree, chunk.views());
    tell_if_possible("wrote {}: no image of it shows the performer\n", options.output.string());
}

}  // namespace

training::OptionalParts optional_parts_of(const std::string& names) {
    training::OptionalParts parts = 0;
    if (names.empty()) return parts;
    for (const std::string& name : split(names, ',')) {
        const auto found = std::find(training::kOptionalParts.begin(), training::kOptionalParts.end(), name);
        if (found == training::kOptionalParts.end())
            throw InputError("--leave-out", names, fmt::format("there is no part \"{}\"", name),
                             fmt::format("the parts are {}", fmt::join(training::kOptionalParts, ", ")));
        parts |= 1u << (found - training::kOptionalParts.begin());
    }
    return parts;
}

std::optional<training::RigCorrection> find_correction(const gpu::Device& device, TrainOptions& options,
                                                       const training::Rig& clip, const ClipPart& frames) {
    TrainOptions segment = options;
    segment.frames = frames;
    const training::Rig rig = frames.of(clip);
    const training::Dataset dataset = load_images(segment, rig, load_options(segment), false);
    if (shows_nothing(dataset)) return std::nullopt;
    if (!correct_rig(device, dataset, refine_of(options.refine), options.settings)) return std::nullopt;  // stopped
    training::RigCorrection correction{options.settings.refine, {}, options.settings.rig};
    for (const training::RigCamera& camera : rig.cameras) correction.cameras.push_back(camera.name);
    return correction;
}

namespace {

// Colours are not tried where segments would choose differently, of surroundings, whose images are few, nor in a team,
// which learns none.
Refine refine_of_run(const TrainOptions& options) {
    const Refine refine = refine_of(options.refine);
    const bool may_try = !options.frames && !options.surroundings && options.settings.team.size == 1;
    return refine.tries_colours && !may_try ? Refine{} : refine;
}

}  // namespace

bool train_rig(const gpu::Device& device, const TrainOptions& options, const training::Rig& clip, const RunView& view) {
    const training::Rig rig = options.frames ? options.frames->of(clip) : clip;
    training::TrainSettings settings = options.settings;
    const Refine refine = refine_of_run(options);
    settings.refine = refine.what.colour;
    settings.try_colours = refine.tries_colours;
    if (options.correction) {
        const training::ColourRefinement& found = options.correction->colour;
        settings.refine.colour |= found.colour;
        settings.refine.exposure |= found.exposure;
        settings.refine.vignetting |= found.vignetting;
        settings.rig = training::changes_of(*options.correction, rig.cameras);
    }
    settings.program = "NeuVV " NEUVV_VERSION;
    settings.adaptive = !options.uniform;
    settings.left_out = optional_parts_of(options.leave_out);
    settings.max_bytes = static_cast<uint64_t>(1e6 * options.max_megabytes);
    const training::LoadOptions load = load_options(options);
    training::Dataset dataset = options.surroundings ? training::read_surroundings(rig, load, image_side(options))
                                                     : load_images(options, rig, load, view.quiet);
    settings.surroundings = options.surroundings;
    if (options.surroundings) say_remarks(dataset.remarks);
    if (options.frames && shows_nothing(dataset)) {
        write_empty(options, dataset);
        return true;
    }
    LiveReport live(device, dataset, load, options);
    const bool searches = refine.needs_search() && !options.frames && !settings.resume;
    if (searches && !correct_rig(device, dataset, refine, settings)) {
        tell_if_possible("interrupted while errors of the rig were searched for: nothing was written\n");
        return false;
    }
    settings.tiles_per_step = training::default_tiles_per_step(device, settings.team.size);
    voctree::VOctree first_tree;
    if (options.init == "psi" && !settings.resume) {
        first_tree = train_psi_tree(options, device, dataset);
        settings.first_tree = &first_tree;
    }
    StatusLine line(true);
    const training::TrainProgress last =
        training::train(device, dataset, settings, options.output, [&](const training::TrainProgress& now) {
            const std::string label = view.label ? view.label(now.fraction) : "";
            if (!view.quiet) report_progress(line, now, label + progress_text(now));
            live.update(now);
            return !stop_requested();
        });
    line.end();
    const bool complete = last.fraction >= 1;
    if (!settings.team.is_first()) return complete;
    tell_if_possible("wrote {}: {} leaves after {} steps, {:.1f} epochs, {}\n", options.output.string(), last.leaves,
                     last.step, last.epochs, format_duration(last.elapsed_s));
    if (last.leaves_stay_large)
        tell_if_possible(
            "most leaves stayed twice as large as pixels, as there were few rays for each; a new run with more "
            "--minutes, or with --resolution, makes them smaller\n");
    if (last.colour_choice == training::ColourChoice::kChosen && !last.colours.empty())
        tell_if_possible("cameras show colours differently, which was corrected (--refine none leaves it)\n");
    print_corrections(last, rig.cameras);
    if (settings.resume && last.step == last.began_at_step)
        tell_if_possible("the run had spent its budget; more --minutes or --steps go on from there\n");
    if (stop_requested() && !complete)
        tell_if_possible("interrupted; the same command with --resume goes on from here\n");
    return complete;
}

}  // namespace neuvv::tools

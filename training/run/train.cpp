#include "training/run/train.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/memory_group.h"
#include "base/seconds.h"
#include "base/trace_file.h"
#include "training/data/dataset_hash.h"
#include "training/run/change_tree.h"
#include "training/run/checkpoint_writer.h"
#include "training/run/run_clock.h"
#include "training/run/schedule.h"
#include "training/run/step_sums.h"
#include "training/run/trained_tree.h"
#include "training/step/batch.h"
#include "training/step/colour_findings.h"
#include "training/tree/bases.h"

namespace neuvv::training {

namespace {

constexpr double kFirstCheckpoint = 10, kCheckpointEvery = 60;  // seconds

// One run, from its data set to its last checkpoint. `run_` has what a checkpoint keeps of how far it has come, but for
// the time, which is the clock's.
class Run {
  public:
    Run(const gpu::Device& device, Dataset& dataset, const TrainSettings& settings, std::filesystem::path output)
        : device_(device),
          dataset_(dataset),
          settings_(settings),
          output_(std::move(output)),
          given_hash_(hash_of(dataset)) {}

    TrainProgress operator()(const TrainCallback& callback);

  private:
    void begin();
    void begin_new();
    voctree::VOctree first_tree();
    void go_on_from_checkpoint();
    const Team& team() const { return settings_.team; }
    // Throws InputError where members cannot train together. Afterwards all have read what they read.
    void expect_alike() const;
    double fraction() const { return clock_.fraction(run_.step); }
    double epochs_done() const { return run_.rays / static_cast<double>(sampler_->rays_per_epoch()); }
    double epochs_of_run() const { return fraction() > 0 ? epochs_done() / fraction() : 0; }
    uint32_t max_leaves() const;
    uint32_t samples_of(uint64_t step) const { return step < run_.several_rays_from ? 1 : kSeveralRays; }
    Batch next_batch(uint64_t step);
    uint32_t fit_to_max_bytes();
    void correct_rig(const RigChanges& changes);
    void choose_colours_if_due();
    void make_step() { training::make_step(device_, trained_, dataset_.cameras.size(), run_.tiles_per_step, team()); }
    void begin_phase_if_due();
    // What is known of the change after the phase that ends, but for the bound on leaves.
    TreeChange change_after_phase();
    // Asks TrainSettings::between_steps.
    bool may_go_on() {
        return !settings_.between_steps ||
               settings_.between_steps({*trained_.step, *sampler_, fraction(), run_.phase, colours_});
    }
    // Reads the run's state from the device. The files are written while training goes on, but not in a team, whose
    // members keep together.
    void save();
    StepSettings step_settings(double time) const;
    // Throws RuntimeFailure where the step of this time went wrong.
    void expect_sound(const StepResult& result, const StepSettings& settings, double time);
    TrainProgress progress() const;

    const gpu::Device& device_;
    Dataset& dataset_;
    TrainSettings settings_;
    std::filesystem::path output_;
    RunClock clock_{settings_.team};
    uint64_t memory_at_begin_ = available_memory_bytes();
    uint64_t given_hash_;  // before the rig was corrected
    RunState run_;
    TrainedTree trained_;
    bool leaves_stay_large_ = false;  // TrainProgress
    CameraColours colours_;
    RigChanges rig_;
    std::vector<RefinedPose> poses_;
    std::optional<BatchSampler> sampler_;  // since begin()
    uint64_t began_at_step_ = 0;
    CheckpointWriter checkpoints_;
    StepSums sums_;
};

void Run::go_on_from_checkpoint() {
    if (!std::filesystem::exists(state_path(output_)))
        throw InputError(state_path(output_).string(), "", "is not there: no run to go on with", Remedy::kTrainAnew);
    Checkpoint checkpoint = load_checkpoint(output_);
    if (checkpoint.tree.frames != dataset_.times.size())
        throw InputError(state_path(output_).string(), "",
                         fmt::format("has {} frames, {} has {}", checkpoint.tree.frames, dataset_.folder.string(),
                                     dataset_.times.size()),
                         "resume with the data set that the run began with");
    for (const size_t cameras : {checkpoint.colours.cameras(), checkpoint.rig.poses.size(),
                                 checkpoint.rig.frames_late.size(), checkpoint.rig.readout.size()})
        if (cameras > 0 && cameras != dataset_.cameras.size())
            throw InputError(state_path(output_).string(), "",
                             fmt::format("is of a rig of {} cameras, {} has {}", cameras, dataset_.folder.string(),
                                         dataset_.cameras.size()),
                             "resume with the data set that the run began with");
    run_ = checkpoint.run;
    colours_ = checkpoint.colours;
    // Members of a team learn no colours. What was only tried so far is dropped.
    if (!team().is_alone() && run_.colour_choice == ColourChoice::kOpen) {
        colours_ = {};
        run_.colour_choice = ColourChoice::kChosen;
    }
    correct_rig(checkpoint.rig);
    trained_.tree = std::move(checkpoint.tree);
    make_step();
    checkpoint.tree = {};
    restore_moments(device_, *trained_.step, checkpoint);
}

void Run::begin_new() {
    run_.seed = settings_.seed;
    run_.max_leaves = settings_.max_leaves;
    run_.max_bytes = settings_.max_bytes;
    run_.adaptive = settings_.adaptive;
    run_.resolution_is_natural = settings_.shape.resolution == 0;
    run_.left_out = settings_.left_out;
    // Devices of members may differ; batches must not.
    run_.tiles_per_step = gather_values(team(), settings_.tiles_per_step)[0];
    run_.weights = settings_.weights;
    run_.program = settings_.program;
    colours_ = CameraColours(dataset_.cameras.size(), dataset_.times.size(), settings_.refine);
    run_.colour_choice = settings_.try_colours ? ColourChoice::kOpen : ColourChoice::kGiven;
    correct_rig(settings_.rig);
    trained_.tree = first_tree();
    if (run_.max_leaves > 0 && trained_.tree.leaf_count > run_.max_leaves)
        throw InputError(Setting{"max-leaves"}, std::to_string(run_.max_leaves),
                         fmt::format("already the first tree has {} leaves", trained_.tree.leaf_count),
                         Remedy::kMoreLeaves);
    if (trained_.tree.leaf_count > max_leaves())
        throw InputError(Setting{"resolution"}, "",
                         fmt::format("already the first tree has {} leaves, and this device, or the memory that this "
                                     "program may take, has room for {}",
                                     trained_.tree.leaf_count, max_leaves()),
                         Remedy::kLowerResolution);
    adopt_first_tree(team(), trained_.tree);
    run_.max_depth =
        run_.leaf_pixels > 0 ? 2 * kMaxNodeLevels : voctree::leaf_positions(trained_.tree)[0].depth + kLevelsAbovePixel;
    make_step();
}

voctree::VOctree Run::first_tree() {
    if (settings_.first_tree) return *settings_.first_tree;
    if (!settings_.surroundings) return initial_tree(dataset_, settings_.shape, kLevelsAbovePixel);
    run_.leaves_along_image = resolution_around(settings_.shape.resolution);
    run_.leaf_pixels = leaf_pixels_of(dataset_, run_.leaves_along_image);
    return surroundings_tree(dataset_, run_.leaf_pixels, settings_.shape.hh_degree);
}

void Run::begin() {
    if (settings_.resume)
        go_on_from_checkpoint();
    else
        begin_new();
    if (settings_.minutes > 0 || settings_.steps > 0) {
        run_.minutes = settings_.minutes;
        run_.steps = settings_.steps;
    } else if (run_.minutes <= 0 && run_.steps == 0) {
        run_.minutes = kDefaultMinutes;
    }
    sampler_.emplace(dataset_, run_.tiles_per_step * team().size, run_.seed, batches_in_a_row(trained_.tree),
                     reach_of_hull(dataset_, trained_.tree.box_min, trained_.tree.box_size,
                                   run_.max_depth - kLevelsAbovePixel, settings_.shape.hull_margin));
    if (settings_.resume && run_.dataset_hash != given_hash_)
        throw InputError(
            state_path(output_).string(), "",
            fmt::format("is of a run on other images, mattes or cameras than those of {}", dataset_.folder.string()),
            "resume with the data set that the run began with");
    run_.dataset_hash = given_hash_;
    clock_.go_on(run_);
    for (uint64_t step = 1; step <= run_.step; ++step) sampler_->skip(samples_of(step));
}

// The bound on the tree's leaves. The device must be able to train all of them as live leaves at once, and the file
// must stay within its bound; new leaves are assumed to take as many bytes as those of the last checkpoint.
uint32_t Run::max_leaves() const {
    uint64_t limit = trainable_leaves(device_, trained_.tree, memory_at_begin_);
    if (run_.max_leaves > 0) limit = std::min<uint64_t>(limit, run_.max_leaves);
    if (const uint64_t file_bytes = checkpoints_.last().bytes; run_.max_bytes > 0 && file_bytes > 0) {
        const uint64_t bytes = run_.max_bytes * (run_.phase + 1 < kPhaseCount ? kEarlyBytesFactor : 1);
        limit = std::min(limit, std::max<uint64_t>(bytes * trained_.tree.leaf_count / file_bytes, 1));
    }
    return static_cast<uint32_t>(limit);
}

void Run::correct_rig(const RigChanges& changes) {
    rig_ = changes;
    if (changes.empty()) return;
    poses_ = refined_poses(changes, dataset_);
    apply(changes, dataset_);
}

void Run::choose_colours_if_due() {
    if (run_.colour_choice != ColourChoice::kOpen || fraction() < kChoosesColoursAt) return;
    colours_.join_exposures();
    colours_.keep(worthwhile(colours_));
    run_.colour_choice = ColourChoice::kChosen;
}

void Run::begin_phase_if_due() {
    if (run_.phase + 1 >= kPhaseCount || fraction() < phases_of(run_.leaf_pixels)[run_.phase + 1].begins) return;
    TreeChange change = change_after_phase();
    const bool covered = change.looks > kMinEpochsForPruning, coarse = run_.phase < first_levels(run_.leaf_pixels);
    if (!covered && !coarse) return;  // the change waits until enough rays were traced
    if (run_.max_bytes > 0) save();   // max_leaves() needs to know how well this tree packs
    ++run_.phase;
    if (!coarse && !run_.adaptive) return;
    checkpoints_.wait();  // what is written takes memory, and so does a change of the tree
    const TraceSpan span("change the tree", run_.phase);
    trained_.step->download(trained_.tree);
    const std::vector<uint32_t> bounds = gather_values(team(), max_leaves());
    change.max_leaves = *std::min_element(bounds.begin(), bounds.end());
    const uint32_t finest = run_.max_depth;
    if (team().is_first()) change_tree(change, trained_.tree, read_use(device_, trained_.step->tally(), trained_.tree));
    leaves_stay_large_ = leaves_stay_large_ || run_.max_depth < finest;
    adopt_first_tree(team(), trained_.tree);
    make_step();
    run_.adam_step = 0;
    run_.phase_rays = 0;
}

TreeChange Run::change_after_phase() {
    TreeChange change{run_, dataset_};
    change.epochs = static_cast<double>(run_.phase_rays) / static_cast<double>(sampler_->rays_per_epoch());
    change.looks = change.epochs * pixels_of_leaves(run_);
    change.rays_of_run = run_.rays / fraction();
    change.hull_margin = settings_.shape.hull_margin;
    change.may_stay_coarse = settings_.may_stay_coarse;
    return change;
}

void Run::expect_alike() const {
    if (team().is_alone()) return;
    assert(!settings_.between_steps && "a team has no hook that could end the run of one member alone");
    if (!colours_.empty() || !rig_.empty())
        throw InputError(state_path(output_).string(), "",
                         "is of a run that corrects cameras, as runs do by default where their colours differ",
                         "go on with it in one process, without mpirun");
    struct Word {
        uint64_t data, step, leaves;
        bool operator==(const Word&) const = default;
    };
    const std::vector<Word> words = gather_values(team(), Word{given_hash_, run_.step, trained_.tree.leaf_count});
    for (size_t rank = 1; rank < words.size(); ++rank)
        if (words[rank] != words[0])
            throw InputError(dataset_.folder.string(), "",
                             fmt::format("is not the same for the first process and process {} of {}, or their "
                                         "checkpoint files are not",
                                         rank + 1, words.size()),
                             "give all processes the same data set and the same output");
}

void Run::save() {
    if (output_.empty() || !team().is_first()) return;
    checkpoints_.wait();
    const TraceSpan span("checkpoint");
    const double start = seconds_now();
    RunState now = run_;
    now.elapsed_s = clock_.own().elapsed_s;
    now.other_s = clock_.own().other_s;
    Checkpoint checkpoint = take_checkpoint(*trained_.step, trained_.tree, now, colours_, rig_);
    checkpoint.frame = dataset_.frame;
    checkpoints_.begin(output_, std::move(checkpoint), start);
    if (!team().is_alone()) checkpoints_.wait();
}

uint32_t Run::fit_to_max_bytes() {
    const CheckpointWriter::Written& last = checkpoints_.last();
    if (run_.max_bytes == 0 || last.bytes <= run_.max_bytes) return last.leaves;
    trained_.step->download(trained_.tree);
    const LeafUse use = read_use(device_, trained_.step->tally(), trained_.tree);
    return save_within_bytes(output_, run_.max_bytes, dataset_, trained_.tree, use, {last.leaves, last.bytes});
}

Batch Run::next_batch(uint64_t step) {
    if (run_.several_rays_from == UINT64_MAX && !has(run_.left_out, OptionalPart::kRays) &&
        fraction() >= kSeveralRaysFrom && epochs_done() >= kSeveralRaysEpochs)
        run_.several_rays_from = step;
    return sampler_->next(samples_of(step), team().rank, team().size);
}

StepSettings Run::step_settings(double time) const {
    StepSettings settings;
    settings.frame = static_cast<float>(frame_of_time(time, trained_.tree.frames));
    settings.rates = learning_rates(fraction(), epochs_of_run());
    if (run_.leaf_pixels <= 0 && run_.phase < kLevelsAbovePixel)
        settings.rates.sigma *= static_cast<float>(kCoarseDensityShare);
    settings.adam.step = run_.adam_step;
    settings.adam.min_used_weight = phases_of(run_.leaf_pixels)[std::min(run_.phase + 1, kPhaseCount - 1)].prune_below;
    if (voctree::has_basis_per_frame(trained_.tree) && epochs_of_run() >= kBoundedEpochs &&
        !has(run_.left_out, OptionalPart::kBound) && settings.frame == std::round(settings.frame))
        settings.adam.least_depth = kLeastDepth;
    settings.stop = kTrainingStop;
    settings.weights = run_.weights;
    settings.weights.smoothness *= smoothness_factor(run_.squared_error);
    settings.colours = !colours_.empty();
    // With as many bases as frames, the first bases can give a leaf any values over time, so they need not learn.
    settings.learn_rows = trained_.tree.bases < trained_.tree.frames && run_.adam_step % kStepsPerRows == 0;
    return settings;
}

void Run::expect_sound(const StepResult& result, const StepSettings& settings, double time) {
    const bool diverged = !std::isfinite(result.rgb_loss);
    if (diverged && !team().is_first()) throw RuntimeFailure("training diverged, as the first process says");
    if (diverged) {
        try {
            checkpoints_.wait();
        } catch (const std::exception&) {  // then the checkpoint before it is there
        }
        throw RuntimeFailure(
            fmt::format("training diverged at step {}: the loss of its {} tiles at time {:.3f} is not a number",
                        run_.step, settings.tiles, time),
            {Remedy::kGoOnTraining,
             fmt::format("{} holds step {}", state_path(output_).string(), checkpoints_.last().step)});
    }
    if (result.overflow > 0)
        throw RuntimeFailure(fmt::format("{} of {} live leaves found no slot on this device", result.overflow,
                                         result.overflow + result.slots),
                             Remedy::kLowerResolution);
}

TrainProgress Run::progress() const {
    TrainProgress now;
    now.elapsed_s = clock_.now().elapsed_s;
    now.other_s = clock_.now().other_s;
    now.fraction = fraction();
    now.eta_s = now.fraction > 0 ? clock_.seconds_left(run_.step) : 0;
    sums_.write_to(now);
    now.step = run_.step;
    now.began_at_step = began_at_step_;
    now.leaves = trained_.tree.leaf_count;
    now.depth = trained_.finest;
    now.epochs = epochs_done();
    now.passes = trained_.step->pass_times();
    now.colours = colours_;
    now.colour_choice = run_.colour_choice;
    now.poses = poses_;
    now.frames_late = rig_.frames_late;
    now.readout = rig_.readout;
    now.leaves_stay_large = leaves_stay_large_;
    now.field = &trained_.step->field();
    return now;
}

TrainProgress Run::operator()(const TrainCallback& callback) {
    begin();
    began_at_step_ = run_.step;
    expect_alike();
    save();
    checkpoints_.wait();  // where nothing can be written, nothing should be trained
    clock_.count_beginning();
    bool go_on = clock_.agree(true), first_saved = false;
    Batch batch = next_batch(run_.step + 1);
    sums_.begin();
    while (go_on && fraction() < 1) {
        choose_colours_if_due();
        clock_.aside([&] { begin_phase_if_due(); });
        clock_.aside([&] { go_on = may_go_on(); });
        if (!go_on) break;
        load_batch(dataset_, batch, trained_.step->rays(), trained_.step->batch(), colours_);
        ++run_.step;
        ++run_.adam_step;
        StepSettings settings = step_settings(batch.time);
        settings.tiles = static_cast<uint32_t>(batch.tiles.size());
        settings.samples = batch.samples;
        trained_.step->submit(settings);
        const Batch trained = std::move(batch);
        batch = next_batch(run_.step + 1);
        const StepResult result = trained_.step->wait();
        expect_sound(result, settings, trained.time);
        colours_.learn(trained, dataset_.cameras, trained_.step->colour_gradients(), camera_colour_rate(fraction()),
                       run_.step);
        const double squared_error = result.rgb_loss / 3;
        run_.squared_error += (run_.squared_error > 0 ? kErrorShare : 1) * (squared_error - run_.squared_error);
        run_.rays += static_cast<double>(result.pixels);
        run_.phase_rays += result.pixels;
        sums_.add(result, settings.weights);
        if (sums_.is_report_due()) {
            const TrainProgress report = progress();
            clock_.aside([&] { go_on = callback(report); });
            sums_.begin_after(report);
        }
        checkpoints_.check();
        const double every_s = first_saved ? kCheckpointEvery : kFirstCheckpoint;
        if (!output_.empty() &&
            checkpoints_.is_due(every_s, clock_.seconds_left(run_.step), trained_.tree.leaf_count)) {
            clock_.aside([&] { save(); });
            first_saved = true;
        }
        go_on = clock_.agree(go_on);
    }
    choose_colours_if_due();            // a run of few steps
    const double reached = fraction();  // the last checkpoint does not finish a run that was stopped before its end
    uint32_t written_leaves = 0;
    clock_.aside([&] {
        save();
        checkpoints_.wait();
        written_leaves = reached >= 1 ? fit_to_max_bytes() : checkpoints_.last().leaves;
    });
    TrainProgress last = progress();
    last.fraction = reached;
    last.leaves = written_leaves;
    if (run_.step > began_at_step_) callback(last);
    last.field = nullptr;
    return last;
}

}  // namespace

uint32_t default_tiles_per_step(const gpu::Device& device, uint32_t members) {
    return device.summary().kind == "cpu" ? 512 : std::max(2048 / std::max(members, 1u), 512u);
}

TrainProgress train(const gpu::Device& device, Dataset& dataset, const TrainSettings& settings,
                    const std::filesystem::path& output, const TrainCallback& callback) {
    Run run(device, dataset, settings, output);
    return run(callback);
}

}  // namespace neuvv::training

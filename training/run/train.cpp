#include "training/run/train.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/memory_group.h"
#include "base/seconds.h"
#include "base/trace_file.h"
#include "training/data/dataset_hash.h"
#include "training/rig/pose_probe.h"
#include "training/run/change_tree.h"
#include "training/run/checkpoint_writer.h"
#include "training/run/schedule.h"
#include "training/step/array_buffers.h"
#include "training/step/batch.h"
#include "training/tree/bases.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

constexpr double kCheckpointShare = 0.05;                       // of the time, at most
constexpr double kFirstCheckpoint = 10, kCheckpointEvery = 60;  // seconds

// One run: the tree on the host (for its topology), the step on the device, and how far they have come.
class Run {
  public:
    Run(const gpu::Device& device, Dataset& dataset, const TrainSettings& settings, std::filesystem::path output)
        : device_(device),
          dataset_(dataset),
          settings_(settings),
          output_(std::move(output)),
          began_(seconds_now()),
          given_hash_(hash_of(dataset)) {}

    TrainProgress operator()(const TrainCallback& callback);

  private:
    void begin();
    void begin_new();
    void go_on_from_checkpoint();
    const Team& team() const { return settings_.team; }
    // What the run has taken. In a team it is what the first member said before this step, so that all members decide
    // alike.
    struct Clock {
        double elapsed_s, other_s;  // as in RunState
    };
    Clock own_clock() const { return {run_.elapsed_s + seconds_now() - began_, run_.other_s}; }
    Clock clock() const { return team().is_alone() ? own_clock() : clock_of_team_; }
    double elapsed() const { return clock().elapsed_s; }
    double steps_s() const { return clock().elapsed_s - clock().other_s; }
    // Takes over the first member's clock. Returns whether all members want to go on.
    bool agree(bool go_on);
    // Throws InputError where members cannot train together. Afterwards all have read what they read.
    void expect_alike() const;
    // Does what is no step of training: its time does not count as progress.
    template <typename Work>
    void aside(const Work& work) {
        const double start = seconds_now();
        work();
        run_.other_s += seconds_now() - start;
    }
    double fraction() const;
    // Seconds until the budget is spent; changes of the tree and the like come on top of a budget in steps.
    double seconds_left() const {
        return fraction() > 0 ? steps_s() / fraction() - steps_s() : std::numeric_limits<double>::infinity();
    }
    double epochs_done() const { return run_.rays / static_cast<double>(sampler_->rays_per_epoch()); }
    double epochs_of_run() const { return fraction() > 0 ? epochs_done() / fraction() : 0; }
    uint64_t leaves_in_memory(uint64_t bytes_of_weights) const;
    uint32_t max_leaves() const;
    uint32_t samples_of(uint64_t step) const { return step < run_.several_rays_from ? 1 : kSeveralRays; }
    Batch next_batch(uint64_t step);
    uint32_t fit_to_max_bytes();
    void correct_rig(const RigChanges& changes);
    void make_step();
    void begin_phase_if_due();
    void change_own_tree(uint32_t max_leaves);
    bool may_go_on();
    // Reads the run's state from the device. The files are written while training goes on, but not in a team, whose
    // members keep together.
    void save();
    double save_will_take() const { return checkpoints_.next_will_take_s(tree_.leaf_count); }
    StepSettings step_settings(double time) const;
    // Throws RuntimeFailure where the step of this time went wrong.
    void expect_sound(const StepResult& result, const StepSettings& settings, double time);
    TrainProgress progress() const;

    const gpu::Device& device_;
    Dataset& dataset_;
    TrainSettings settings_;
    std::filesystem::path output_;
    double began_;
    uint64_t memory_at_begin_ = available_memory_bytes();
    Clock clock_of_team_{};
    uint64_t given_hash_;  // before the rig was corrected
    RunState run_;
    voctree::VOctree tree_;
    CameraColours colours_;
    RigChanges rig_;
    std::vector<RefinedPose> poses_;
    uint32_t finest_ = 0;  // octree depth of the tree's finest leaves
    std::unique_ptr<TrainingStep> step_;
    std::optional<BatchSampler> sampler_;  // since begin()
    uint64_t began_at_step_ = 0;
    double saved_at_ = 0;  // when the state of the last checkpoint had been read
    CheckpointWriter checkpoints_;
    // Sums since the last report.
    double loss_sum_ = 0, rgb_sum_ = 0, grad_sum_ = 0, rays_sum_ = 0, steps_sum_ = 0, reported_at_ = 0;
    TrainProgress reported_;
};

void Run::go_on_from_checkpoint() {
    if (!std::filesystem::exists(state_path(output_)))
        throw InputError(state_path(output_).string(), "", "is not there: no run to go on with",
                         "train without --resume");
    Checkpoint checkpoint = load_checkpoint(output_);
    if (checkpoint.tree.frames != dataset_.times.size())
        throw InputError(state_path(output_).string(), "",
                         fmt::format("has {} frames, {} has {}", checkpoint.tree.frames, dataset_.folder.string(),
                                     dataset_.times.size()),
                         "resume with the data set that the run began with");
    for (const size_t cameras :
         {checkpoint.colours.cameras(), checkpoint.rig.poses.size(), checkpoint.rig.frames_late.size()})
        if (cameras > 0 && cameras != dataset_.cameras.size())
            throw InputError(state_path(output_).string(), "",
                             fmt::format("is of a rig of {} cameras, {} has {}", cameras, dataset_.folder.string(),
                                         dataset_.cameras.size()),
                             "resume with the data set that the run began with");
    run_ = checkpoint.run;
    colours_ = checkpoint.colours;
    correct_rig(checkpoint.rig);
    tree_ = std::move(checkpoint.tree);
    make_step();
    checkpoint.tree = {};
    restore_moments(device_, *step_, checkpoint);
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
    correct_rig(settings_.rig);
    tree_ = settings_.first_tree ? *settings_.first_tree : initial_tree(dataset_, settings_.shape, kLevelsAbovePixel);
    if (run_.max_leaves > 0 && tree_.leaf_count > run_.max_leaves)
        throw InputError("--max-leaves", std::to_string(run_.max_leaves),
                         fmt::format("already the first tree has {} leaves", tree_.leaf_count),
                         "allow more, or choose a lower --resolution");
    if (tree_.leaf_count > max_leaves())
        throw InputError("--resolution", "",
                         fmt::format("already the first tree has {} leaves, and this device, or the memory that this "
                                     "program may take, has room for {}",
                                     tree_.leaf_count, max_leaves()),
                         "choose a lower resolution or --hh-degree");
    adopt_first_tree(team(), tree_);
    run_.max_depth = voctree::leaf_positions(tree_)[0].depth + kLevelsAbovePixel;
    make_step();
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
    sampler_.emplace(dataset_, run_.tiles_per_step * team().size, run_.seed, batches_in_a_row(tree_),
                     reach_of_hull(dataset_, tree_.box_min, tree_.box_size, run_.max_depth - kLevelsAbovePixel,
                                   settings_.shape.hull_margin));
    if (settings_.resume && run_.dataset_hash != given_hash_)
        throw InputError(
            state_path(output_).string(), "",
            fmt::format("is of a run on other images, mattes or cameras than those of {}", dataset_.folder.string()),
            "resume with the data set that the run began with");
    run_.dataset_hash = given_hash_;
    for (uint64_t step = 1; step <= run_.step; ++step) sampler_->skip(samples_of(step));
}

// How many leaves there is room for in the memory that was free when the run began, with its images read: where a
// control group allows little, the process would be killed without a word. A leaf takes its weights several times, with
// those of the checkpoint that is being written, and of a device whose memory is the system's also their moments and
// gradients; and what does not depend on their number, such as its place and its slice (measured: 2.4 kB of leaves with
// 176 bytes of weights).
uint64_t Run::leaves_in_memory(uint64_t bytes_of_weights) const {
    constexpr uint64_t kOnHost = 3, kOnBoth = 6, kOfAny = 1400, kPipelines = uint64_t{100} << 20;
    const uint64_t bytes = bytes_of_weights * (device_.summary().kind == "cpu" ? kOnBoth : kOnHost) + kOfAny;
    return (memory_at_begin_ - std::min(memory_at_begin_, kPipelines)) / bytes;
}

// The bound on the tree's leaves. The device must be able to train all of them as live leaves at once, and the file
// must stay within its bound; new leaves are assumed to take as many bytes as those of the last checkpoint.
uint32_t Run::max_leaves() const {
    uint64_t limit = std::min(kMaxTrainingLeaves, max_training_slots(device_, tree_.hh_degree));
    const uint64_t planes = 2 * ((tree_.bases + 3) / 4) + hh_count(tree_.hh_degree);
    limit = std::min<uint64_t>(limit, array_buffers(device_).max_elements(16) / planes);
    limit = std::min(limit, device_.max_allocation_bytes() / (16 * planes));
    limit = std::min(limit, leaves_in_memory(16 * planes));
    if (run_.max_leaves > 0) limit = std::min<uint64_t>(limit, run_.max_leaves);
    if (const uint64_t file_bytes = checkpoints_.last().bytes; run_.max_bytes > 0 && file_bytes > 0) {
        const uint64_t bytes = run_.max_bytes * (run_.phase + 1 < kPhaseCount ? kEarlyBytesFactor : 1);
        limit = std::min(limit, std::max<uint64_t>(bytes * tree_.leaf_count / file_bytes, 1));
    }
    return static_cast<uint32_t>(limit);
}

// The share of the steps that are done. In a budget of minutes, it is the time of the steps so far in that time and
// what is left: were a checkpoint or a change of the tree progress, too, a phase could end before rays have seen its
// leaves, and leaves would be removed that are needed.
double Run::fraction() const {
    double share = 0;
    if (run_.steps > 0) share = static_cast<double>(run_.step) / static_cast<double>(run_.steps);
    if (run_.minutes > 0) {
        const double left = 60 * run_.minutes - elapsed();
        share = std::max(share, left > 0 ? steps_s() / (steps_s() + left) : 1.0);
    }
    return std::min(share, 1.0);
}

void Run::correct_rig(const RigChanges& changes) {
    rig_ = changes;
    if (changes.empty()) return;
    const auto [low, high] = first_box(dataset_);
    const glm::dvec3 centre = 0.5 * (low + high);
    for (size_t i = 0; i < changes.poses.size(); ++i) {
        const stage::Camera& given = dataset_.cameras[i];
        poses_.push_back({changes.poses[i], image_motion(given, changes.poses[i], centre),
                          is_at_bound(changes.poses[i], pose_bounds(given, centre))});
    }
    apply(changes, dataset_);
}

void Run::make_step() {
    const TraceSpan span("buffers of the step");
    finest_ = 0;
    for (const voctree::LeafPosition& position : voctree::leaf_positions(tree_))
        finest_ = std::max(finest_, position.depth);
    step_.reset();  // frees its memory before the next one takes some
    // search_rig() also traces variants of a camera.
    const uint32_t cameras = std::max(static_cast<uint32_t>(dataset_.cameras.size()), kPoseVariants);
    // A member's share of a batch may be larger than its tiles_per_step by a part of an image tile.
    constexpr uint32_t kRaysOfPixel = kSeveralRays * kSeveralRays;
    const uint32_t tiles = (run_.tiles_per_step + kRaysOfPixel - 1) / kRaysOfPixel * kRaysOfPixel;
    step_ = std::make_unique<TrainingStep>(device_, tree_, cameras, tiles, team());
}

void Run::begin_phase_if_due() {
    if (run_.phase + 1 >= kPhaseCount || fraction() < kPhases[run_.phase + 1].begins) return;
    const double epochs = static_cast<double>(run_.phase_rays) / static_cast<double>(sampler_->rays_per_epoch());
    const bool covered = epochs > kMinEpochsForPruning, coarse = run_.phase < kLevelsAbovePixel;
    if (!covered && !coarse) return;  // the change waits until enough rays were traced
    if (run_.max_bytes > 0) save();   // max_leaves() needs to know how well this tree packs
    ++run_.phase;
    if (!coarse && !run_.adaptive) return;
    checkpoints_.wait();  // what is written takes memory, and so does a change of the tree
    const TraceSpan span("change the tree", run_.phase);
    step_->download(tree_);
    const std::vector<uint32_t> bounds = gather_values(team(), max_leaves());
    if (team().is_first()) change_own_tree(*std::min_element(bounds.begin(), bounds.end()));
    adopt_first_tree(team(), tree_);
    make_step();
    run_.adam_step = 0;
    run_.phase_rays = 0;
}

void Run::change_own_tree(uint32_t max_leaves) {
    TreeChange change{run_, dataset_};
    change.epochs = static_cast<double>(run_.phase_rays) / static_cast<double>(sampler_->rays_per_epoch());
    change.rays_of_run = run_.rays / fraction();
    change.max_leaves = max_leaves;
    change.hull_margin = settings_.shape.hull_margin;
    change.may_stay_coarse = settings_.may_stay_coarse;
    change_tree(change, tree_, read_use(device_, step_->tally(), tree_));
}

void Run::expect_alike() const {
    if (team().is_alone()) return;
    assert(!settings_.between_steps && "a team has no hook that could end the run of one member alone");
    if (!colours_.empty() || !rig_.empty())
        throw InputError(state_path(output_).string(), "", "is of a run that refines cameras",
                         "go on with it in one process, without mpirun");
    struct Word {
        uint64_t data, step, leaves;
        bool operator==(const Word&) const = default;
    };
    const std::vector<Word> words = gather_values(team(), Word{given_hash_, run_.step, tree_.leaf_count});
    for (size_t rank = 1; rank < words.size(); ++rank)
        if (words[rank] != words[0])
            throw InputError(dataset_.folder.string(), "",
                             fmt::format("is not the same for the first process and process {} of {}, or their "
                                         "checkpoint files are not",
                                         rank + 1, words.size()),
                             "give all processes the same data set and the same output");
}

bool Run::agree(bool go_on) {
    if (team().is_alone()) return go_on;
    struct Word {
        Clock clock;
        bool go_on;
    };
    const std::vector<Word> words = gather_values(team(), Word{own_clock(), go_on});
    clock_of_team_ = words[0].clock;
    return std::all_of(words.begin(), words.end(), [](const Word& word) { return word.go_on; });
}

// Asks TrainSettings::between_steps.
bool Run::may_go_on() {
    if (!settings_.between_steps) return true;
    return settings_.between_steps({*step_, *sampler_, fraction(), run_.phase, colours_});
}

void Run::save() {
    if (output_.empty() || !team().is_first()) return;
    checkpoints_.wait();
    const TraceSpan span("checkpoint");
    const double start = seconds_now();
    RunState now = run_;
    now.elapsed_s = own_clock().elapsed_s;
    Checkpoint checkpoint = take_checkpoint(*step_, tree_, now, colours_, rig_);
    checkpoint.frame = dataset_.frame;
    checkpoints_.begin(output_, std::move(checkpoint), start);
    saved_at_ = seconds_now();
    if (!team().is_alone()) checkpoints_.wait();
}

// Removes leaves of lowest maximum weight from the finished .nvv where it exceeds its bound; the state keeps all
// leaves. Returns how many the .nvv has.
uint32_t Run::fit_to_max_bytes() {
    uint32_t leaves = checkpoints_.last().leaves;
    uint64_t bytes = checkpoints_.last().bytes;
    if (run_.max_bytes == 0 || bytes <= run_.max_bytes) return leaves;
    step_->download(tree_);
    const LeafUse use = read_use(device_, step_->tally(), tree_);
    while (bytes > run_.max_bytes && leaves > 1) {
        GrowSettings settings;
        settings.max_leaves = std::clamp(static_cast<uint32_t>(run_.max_bytes * leaves / bytes), 1u, leaves - 1);
        leaves = save_compact(output_, grow(dataset_, tree_, use, settings), dataset_.frame);
        bytes = std::filesystem::file_size(output_);
    }
    return leaves;
}

Batch Run::next_batch(uint64_t step) {
    if (run_.several_rays_from == UINT64_MAX && !has(run_.left_out, OptionalPart::kRays) &&
        fraction() >= kSeveralRaysFrom && epochs_done() >= kSeveralRaysEpochs)
        run_.several_rays_from = step;
    return sampler_->next(samples_of(step), team().rank, team().size);
}

StepSettings Run::step_settings(double time) const {
    StepSettings settings;
    settings.frame = static_cast<float>(frame_of_time(time, tree_.frames));
    settings.rates = learning_rates(fraction(), epochs_of_run());
    if (run_.phase < kLevelsAbovePixel) settings.rates.sigma *= static_cast<float>(kCoarseDensityShare);
    settings.adam.step = run_.adam_step;
    settings.adam.min_used_weight = kPhases[std::min(run_.phase + 1, kPhaseCount - 1)].prune_below;
    if (voctree::has_basis_per_frame(tree_) && epochs_of_run() >= kBoundedEpochs &&
        !has(run_.left_out, OptionalPart::kBound) && settings.frame == std::round(settings.frame))
        settings.adam.least_depth = kLeastDepth;
    settings.stop = kTrainingStop;
    settings.weights = run_.weights;
    settings.colours = !colours_.empty();
    // With as many bases as frames, the first bases can give a leaf any values over time, so they need not learn.
    settings.learn_rows = tree_.bases < tree_.frames && run_.adam_step % kStepsPerRows == 0;
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
            fmt::format("training diverged at step {}: the loss of its {} tiles at time {:.3f} is not a number; {} "
                        "holds step {}, from which --resume goes on",
                        run_.step, settings.tiles, time, state_path(output_).string(), checkpoints_.last().step));
    }
    if (result.overflow > 0)
        throw RuntimeFailure(
            fmt::format("{} of {} live leaves found no slot on this device; choose a lower --resolution or --hh-degree",
                        result.overflow, result.overflow + result.slots));
}

TrainProgress Run::progress() const {
    TrainProgress now;
    now.elapsed_s = elapsed();
    now.other_s = clock().other_s;
    now.fraction = fraction();
    now.eta_s = now.fraction > 0 ? seconds_left() : 0;
    now.rays_per_s = reported_.rays_per_s;
    now.loss = reported_.loss;
    now.psnr = reported_.psnr;
    now.rgb_loss = reported_.rgb_loss;
    now.grad_loss = reported_.grad_loss;
    if (steps_sum_ > 0) {
        now.rays_per_s = rays_sum_ / std::max(seconds_now() - reported_at_, 1e-3);
        now.loss = loss_sum_ / steps_sum_;
        now.rgb_loss = rgb_sum_ / steps_sum_;
        now.grad_loss = grad_sum_ / steps_sum_;
        now.psnr = -10 * std::log10(std::max(rgb_sum_ / steps_sum_ / 3, 1e-10));
    }
    now.step = run_.step;
    now.began_at_step = began_at_step_;
    now.leaves = tree_.leaf_count;
    now.depth = finest_;
    now.epochs = epochs_done();
    now.passes = step_->pass_times();
    now.colours = colours_;
    now.poses = poses_;
    now.frames_late = rig_.frames_late;
    now.field = &step_->field();
    return now;
}

TrainProgress Run::operator()(const TrainCallback& callback) {
    begin();
    began_at_step_ = run_.step;
    expect_alike();
    save();
    checkpoints_.wait();  // where nothing can be written, nothing should be trained
    run_.other_s += seconds_now() - began_;
    bool go_on = agree(true), first_saved = false;
    Batch batch = next_batch(run_.step + 1);
    reported_at_ = seconds_now();
    while (go_on && fraction() < 1) {
        aside([&] { begin_phase_if_due(); });
        aside([&] { go_on = may_go_on(); });
        if (!go_on) break;
        load_batch(dataset_, batch, step_->rays(), step_->batch(), colours_);
        ++run_.step;
        ++run_.adam_step;
        StepSettings settings = step_settings(batch.time);
        settings.tiles = static_cast<uint32_t>(batch.tiles.size());
        settings.samples = batch.samples;
        step_->submit(settings);
        const Batch trained = std::move(batch);
        batch = next_batch(run_.step + 1);
        const StepResult result = step_->wait();
        expect_sound(result, settings, trained.time);
        colours_.learn(trained, dataset_.cameras, step_->colour_gradients(), camera_colour_rate(fraction()), run_.step);
        rays_sum_ += static_cast<double>(result.pixels);
        run_.rays += static_cast<double>(result.pixels);
        run_.phase_rays += result.pixels;
        rgb_sum_ += result.rgb_loss;
        grad_sum_ += result.grad_loss;
        loss_sum_ += result.total(settings.weights);
        ++steps_sum_;
        if (seconds_now() - reported_at_ >= 1) {
            reported_ = progress();
            aside([&] { go_on = callback(reported_); });
            loss_sum_ = rgb_sum_ = grad_sum_ = rays_sum_ = steps_sum_ = 0;
            reported_at_ = seconds_now();
        }
        checkpoints_.check();
        const double wait =
            std::max(first_saved ? kCheckpointEvery : kFirstCheckpoint, save_will_take() / kCheckpointShare);
        // A run that ends sooner than its checkpoint is written would only have to wait for it.
        if (!output_.empty() && seconds_now() - saved_at_ > wait && seconds_left() > save_will_take()) {
            aside([&] { save(); });
            first_saved = true;
        }
        go_on = agree(go_on);
    }
    const double reached = fraction();  // the last checkpoint does not finish a run that was stopped before its end
    uint32_t written_leaves = 0;
    aside([&] {
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

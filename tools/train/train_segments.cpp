// The training of a clip in segments, which any number of processes may share.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "gpu/device.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/train/refine.h"
#include "tools/train/replacement.h"
#include "tools/train/train_run.h"
#include "training/data/segments.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"

namespace neuvv::tools {

namespace {

constexpr double kLookAround_s = 2;          // how often a process looks how far the others are
constexpr double kLongestBeginning_s = 300;  // that the first rank may take to write the index

void sleep_for(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// Whether the first rank has begun the clip there.
bool has_begun(const std::filesystem::path& clip, const Ranks& ranks) {
    try {
        const std::vector<uint8_t> text = read_file(job_file(clip), 4096);
        return std::string(text.begin(), text.end()) == ranks.job;
    } catch (const InputError&) {
        return false;
    }
}

// Of the first rank. False where Ctrl-C came before the clip was begun.
bool begin(const gpu::Device& device, TrainOptions& options, const training::Rig& rig, const SegmentPlan& plan,
           const Ranks& ranks) {
    if (!correct_clip(device, options, rig, plan)) return false;
    expect_nobody_trains(options, plan);  // the search may have taken minutes
    begin_segments(options, plan);
    if (ranks.count > 1) write_text_file(job_file(options.output), ranks.job);
    options.settings.resume = true;
    return true;
}

class SegmentedRun {
  public:
    SegmentedRun(const gpu::Device& device, const TrainOptions& options, const training::Rig& rig,
                 const SegmentPlan& plan, const Ranks& ranks)
        : device_(device),
          options_(options),
          rig_(rig),
          times_(training::times_of(rig)),
          segments_(plan.segments),
          frames_(plan.frames()),
          learnt_frames_(plan.learnt_frames()),
          ranks_(ranks),
          finished_(plan.segments.size()) {
        if (options.correction) training::move_late_shots(*options.correction, rig_);
    }

    // Returns when all segments are finished that this process is to wait for, or when it was stopped.
    void run();

  private:
    bool is_finished(size_t segment);
    std::string name_of(size_t segment) const { return fmt::format("segment {} of {}", segment + 1, segments_.size()); }
    // Trains all segments that nobody else trains.
    void train_free_ones();
    void train(size_t segment, const training::RunClaim& claim);
    void leave_out(size_t segment, const std::runtime_error& error);
    // Those that are neither finished nor failed here.
    std::vector<size_t> unfinished();
    // How much of the clip's budget is spent, 0..1. It is looked up every few seconds.
    double fraction_of_all(size_t own, double own_fraction);
    void say_who_trains(const std::vector<size_t>& segments) const;
    void conclude() const;

    const gpu::Device& device_;
    const TrainOptions& options_;
    training::Rig rig_;
    std::vector<double> times_;
    const std::vector<voctree::ClipSegment>& segments_;
    uint32_t frames_, learnt_frames_;  // of all of these
    const Ranks& ranks_;
    std::vector<bool> finished_;  // what is known; is_finished() looks again
    std::set<size_t> failed_;
    std::string problem_;          // of the first that failed
    bool machine_failed_ = false;  // a RuntimeFailure was among them
    bool said_interrupted_ = false;
    double looked_at_ = -INFINITY, others_fraction_ = 0;
};

// A segment is finished when it is there and its checkpoint file is gone.
bool SegmentedRun::is_finished(size_t segment) {
    const std::filesystem::path& file = segments_[segment].file;
    if (!finished_[segment])
        finished_[segment] = is_replaced(options_) ||
                             (std::filesystem::exists(file) && !std::filesystem::exists(training::state_path(file)));
    return finished_[segment];
}

std::vector<size_t> SegmentedRun::unfinished() {
    std::vector<size_t> segments;
    for (size_t i = 0; i < segments_.size(); ++i)
        if (!failed_.contains(i) && !is_finished(i)) segments.push_back(i);
    return segments;
}

double SegmentedRun::fraction_of_all(size_t own, double own_fraction) {
    if (seconds_now() - looked_at_ > kLookAround_s) {
        others_fraction_ = 0;
        for (size_t i = 0; i < segments_.size(); ++i) {
            if (i == own) continue;
            const double share = budget_share(segments_[i], learnt_frames_);
            if (is_finished(i))
                others_fraction_ += share;
            else if (const auto claim = training::claim_of(segments_[i].file))
                others_fraction_ += share * claim->fraction;
        }
        looked_at_ = seconds_now();
    }
    const double own_share = own < segments_.size() ? budget_share(segments_[own], learnt_frames_) : 0;
    return others_fraction_ + own_share * own_fraction;
}

void SegmentedRun::train(size_t segment, const training::RunClaim& claim) {
    const voctree::ClipSegment& frames = segments_[segment];
    if (ranks_.is_first()) say("{}: frames {} to {}\n", name_of(segment), frames.first, frames.end() - 1);
    RunView view{!ranks_.is_first(), [&](double fraction) {
                     claim.report(fraction);
                     return fmt::format("{}, all {:.0f} % | ", name_of(segment),
                                        100 * fraction_of_all(segment, fraction));
                 }};
    TrainOptions options = options_of(options_, frames, budget_share(frames, learnt_frames_));
    options.frames = {times_, frames.first, frames.frames_of_file()};
    if (!ranks_.is_first()) options.live = {};
    try {
        if (train_rig(device_, options, rig_, view))
            std::filesystem::remove(training::state_path(frames.file));
        else
            said_interrupted_ = true;
    } catch (const InputError& error) {  // the other segments are worth having
        leave_out(segment, error);
    } catch (const RuntimeFailure& failure) {  // perhaps of this segment alone
        const auto* vulkan = dynamic_cast<const gpu::VulkanError*>(&failure);
        if (vulkan && vulkan->device_lost()) throw;
        machine_failed_ = true;
        leave_out(segment, failure);
    }
    return_freed_memory();
}

void SegmentedRun::leave_out(size_t segment, const std::runtime_error& error) {
    say("{} is left out: {}\n", name_of(segment), message_of(error));
    if (failed_.empty()) problem_ = message_of(error);
    failed_.insert(segment);
}

void SegmentedRun::train_free_ones() {
    for (const size_t i : unfinished()) {
        if (stop_requested()) {
            if (ranks_.is_first() && !said_interrupted_)
                tell_if_possible("interrupted; the same command with --resume goes on from here\n");
            return;
        }
        if (is_finished(i)) continue;
        const std::optional<training::RunClaim> claim = training::RunClaim::take(segments_[i].file);
        if (claim && !is_finished(i)) train(i, *claim);
    }
}

void SegmentedRun::say_who_trains(const std::vector<size_t>& segments) const {
    for (const size_t i : segments)
        if (const auto claim = training::claim_of(segments_[i].file))
            tell_if_possible("{} is left to {}, which trains it\n", name_of(i), claim->owner);
}

void SegmentedRun::run() {
    StatusLine line(false);
    for (;;) {
        train_free_ones();
        const std::vector<size_t> left = unfinished();
        if (left.empty() || stop_requested()) break;
        const bool all_taken = std::all_of(left.begin(), left.end(),
                                           [&](size_t i) { return training::claim_of(segments_[i].file).has_value(); });
        if (all_taken && ranks_.count == 1) {
            say_who_trains(left);
            break;
        }
        sleep_for(0.2);
        if (ranks_.is_first() && line.is_due())
            line.print(fmt::format("all {:.0f} % | {} of {} segments are being trained by other processes",
                                   100 * fraction_of_all(segments_.size(), 0), left.size(), segments_.size()));
    }
    line.end();
    conclude();
}

void SegmentedRun::conclude() const {
    if (!failed_.empty() && !stop_requested()) {
        const std::string problem = fmt::format("{} of {} segments could not be trained, the first because of {}",
                                                failed_.size(), segments_.size(), problem_);
        const std::string fix = "mend that, and give the same command with --resume";
        if (machine_failed_) throw RuntimeFailure(fmt::format("{}: {}; {}", options_.clip().string(), problem, fix));
        throw InputError(options_.clip().string(), "", problem, fix);
    }
    if (std::find(finished_.begin(), finished_.end(), false) != finished_.end()) {
        if (ranks_.is_first() && !options_.replaces.empty())
            tell_if_possible("{} stays as it is until the new one is whole\n", options_.replaces.string());
        return;
    }
    if (!options_.replaces.empty()) finish_replacement(options_);
    if (ranks_.is_first())
        tell_if_possible("wrote {}: {} frames in {} segments\n", options_.clip().string(), frames_, segments_.size());
}

}  // namespace

std::filesystem::path place_of_first_rank(const std::filesystem::path& clip, const Ranks& ranks) {
    for (double start = seconds_now(); !stop_requested(); sleep_for(0.1)) {
        for (const std::filesystem::path& place : {clip, replacement_of(clip)})
            if (has_begun(place, ranks)) return place;
        // The first rank has taken the clip: it may be searching the rig.
        if (training::claim_of(clip)) start = seconds_now();
        if (seconds_now() - start > kLongestBeginning_s)
            throw RuntimeFailure(
                fmt::format("{}: the first of the {} processes has not begun the clip", clip.string(), ranks.count));
    }
    return {};
}

bool correct_clip(const gpu::Device& device, TrainOptions& options, const training::Rig& rig, const SegmentPlan& plan) {
    if (!refine_of(options.refine).needs_search()) return true;
    const std::vector<double> times = training::times_of(rig);
    std::string problem = "none of their images shows the performer";
    for (const size_t i : voctree::segments_from_middle(plan.segments.size())) {
        const voctree::ClipSegment& segment = plan.segments[i];
        try {
            options.correction = find_correction(device, options, rig, {times, segment.first, segment.frames});
        } catch (const InputError& error) {  // another segment may do
            say("the rig is searched in another segment: {}\n", message_of(error));
            problem = message_of(error);
        }
        if (options.correction) return true;
        if (stop_requested()) {
            tell_if_possible("interrupted while errors of the rig were searched for: nothing was written\n");
            return false;
        }
    }
    throw InputError("--refine", options.refine, "finds nothing in any segment: " + problem,
                     "mend that, or leave --refine out");
}

// What the clip corrects. Throws InputError where that is to be found, but was not when the clip was begun.
std::optional<training::RigCorrection> correction_of(const TrainOptions& options) {
    std::optional<training::RigCorrection> correction = training::read_rig_correction(options.output);
    if (!correction && refine_of(options.refine).needs_search())
        throw InputError("--refine", options.refine,
                         fmt::format("{} has no rig.json: it was begun without", options.clip().string()),
                         "leave it out, or train the whole clip again without --resume");
    return correction;
}

void train_segments(const gpu::Device& device, TrainOptions& options, const training::Rig& rig, const SegmentPlan& plan,
                    const Ranks& ranks) {
    if (!options.settings.resume && ranks.is_first() && !begin(device, options, rig, plan, ranks)) return;
    options.correction = correction_of(options);
    if (!stop_requested()) SegmentedRun(device, options, rig, plan, ranks).run();
}

}  // namespace neuvv::tools

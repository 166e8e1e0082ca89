// The plan of a clip in segments: where it is cut, and what each segment's run is given.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "tools/options.h"
#include "tools/train/train_run.h"
#include "training/data/segments.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

namespace {

// Segments of so many frames overlap the next one by one frame or two. For shorter ones, that would cost too much.
constexpr uint32_t kLeastForOverlap = 4, kLeastForTwo = 8;

constexpr double kUsualSecond = 25;  // frames, where a rig does not say how many there are a second

// By how many frames a segment overlaps the next one; there are `more` frames behind it. Each frame shall have a basis
// of its own.
uint32_t overlap_of(uint32_t length, uint32_t more, uint32_t bases) {
    const uint32_t wanted = length >= kLeastForTwo ? 2 : length >= kLeastForOverlap ? 1 : 0;
    return std::min({wanted, more, std::max(bases, length) - length});
}

// The frames that --segment asks for. "auto" is a second, but no more than can have a basis each, with the overlap.
uint32_t longest_segment(const TrainOptions& options, double fps) {
    const std::string& text = options.segment;
    if (text == "auto") {
        const double second = fps > 0 ? std::clamp(std::round(fps), 1.0, double{kMaxBases}) : kUsualSecond;
        return std::min(static_cast<uint32_t>(second), std::max(options.settings.shape.bases, 3u) - 2);
    }
    const uint32_t frames = parse_frames("--segment", text, fps);
    if (frames < 1) throw InputError("--segment", text, "is no frame", "give at least one frame");
    return frames;
}

// The steps of a part of a budget; of none, none.
uint64_t share_of(uint64_t steps, double share) {
    return steps == 0 ? 0 : std::max<uint64_t>(std::llround(static_cast<double>(steps) * share), 1);
}

// Throws InputError where frames are not at even times: a segment's frames are then not those that `eval` and players
// find by their times.
void expect_even_times(const training::Rig& rig, const std::vector<double>& times) {
    if (const auto uneven = training::uneven_time(times, 0))
        throw InputError("--segment", rig.file,
                         fmt::format("its {} times are not even: {} is that of frame {:.2f}, not {}", times.size(),
                                     uneven->time, uneven->at, uneven->frame),
                         "give each frame f of n the time f / (n − 1), or train without --segment");
}

// The index of a clip that is there already, with its segments where they are trained.
voctree::ClipIndex index_before(const TrainOptions& options, const training::Rig& rig, uint32_t frames) {
    if (!voctree::is_segmented(options.clip()))
        throw InputError(options.output.string(), "", "has no clip.json: no run to go on with",
                         "train without --resume");
    if (options.settings.minutes == 0 && options.settings.steps == 0)
        throw InputError(
            options.output.string(), "",
            "is a clip in segments, whose budget is not known when it is resumed or a part is trained again",
            "give --minutes or --steps; with --resume, those of the command that began it");
    voctree::ClipIndex index =
        voctree::read_clip_index(voctree::is_segmented(options.output) ? options.output : options.replaces);
    for (voctree::ClipSegment& segment : index.segments) segment.file = options.output / segment.file.filename();
    if (index.frames() != frames)
        throw InputError(options.output.string(), "",
                         fmt::format("has {} frames, {} has {}", index.frames(), options.dataset.string(), frames),
                         "use the data set that the run began with");
    if (!options.segment.empty() &&
        training::segment_lengths(frames, longest_segment(options, rig.fps)).size() != index.segments.size())
        throw InputError("--segment", options.segment,
                         fmt::format("{} has {} segments", options.output.string(), index.segments.size()),
                         "leave it out: the clip keeps its segments");
    return index;
}

}  // namespace

uint32_t SegmentPlan::frames() const {
    uint32_t frames = 0;
    for (const voctree::ClipSegment& segment : segments) frames += segment.frames;
    return frames;
}

uint32_t SegmentPlan::learnt_frames() const {
    uint32_t frames = 0;
    for (const voctree::ClipSegment& segment : segments) frames += segment.frames_of_file();
    return frames;
}

std::vector<voctree::ClipSegment> segments_of_part(const TrainOptions& options, const voctree::ClipIndex& index) {
    const double fps = double{index.fps};
    const uint32_t begin = options.from.empty() ? 0 : parse_frames("--from", options.from, fps);
    const uint32_t end = options.to.empty() ? index.frames() : parse_frames("--to", options.to, fps);
    if (begin >= end || end > index.frames())
        throw InputError("--from, --to", fmt::format("frames {} to {}", begin, end),
                         fmt::format("are no part of {}, which has {} frames", options.clip().string(), index.frames()),
                         "--from is the first frame of the part, --to the first after it");
    std::vector<voctree::ClipSegment> segments;
    for (const voctree::ClipSegment& segment : index.segments)
        if (segment.first < end && segment.end() > begin) segments.push_back(segment);
    return segments;
}

SegmentPlan plan_segments(const TrainOptions& options, const training::Rig& rig) {
    const std::vector<double> times = training::times_of(rig);
    const auto frames = static_cast<uint32_t>(times.size());
    expect_even_times(rig, times);
    SegmentPlan plan;
    if (options.settings.resume || options.is_part()) {
        plan.clip = index_before(options, rig, frames);
        plan.segments = segments_of_part(options, plan.clip);
        return plan;
    }
    if (rig.fps > 0) plan.clip.fps = static_cast<float>(rig.fps);
    for (const uint32_t length : training::segment_lengths(frames, longest_segment(options, rig.fps))) {
        const uint32_t first = plan.clip.segments.empty() ? 0 : plan.clip.frames();
        plan.clip.segments.push_back({options.output / voctree::segment_file_name(first), first, length,
                                      overlap_of(length, frames - first - length, options.settings.shape.bases)});
    }
    plan.segments = plan.clip.segments;
    return plan;
}

TrainOptions options_of(const TrainOptions& clip, const voctree::ClipSegment& segment, double share) {
    TrainOptions options = clip;
    options.output = segment.file;
    training::TrainSettings& settings = options.settings;
    if (settings.steps == 0 && settings.minutes == 0) settings.minutes = training::kDefaultMinutes;
    settings.minutes *= share;
    settings.steps = share_of(settings.steps, share);
    options.psi_minutes *= share;
    options.psi_steps = share_of(options.psi_steps, share);
    options.max_megabytes *= share;
    // A segment is finished when its checkpoint file is gone.
    settings.resume = std::filesystem::exists(training::state_path(segment.file));
    return options;
}

void expect_unclaimed(const std::vector<voctree::ClipSegment>& segments) {
    for (const voctree::ClipSegment& segment : segments)
        if (const auto claim = training::claim_of(segment.file))
            throw InputError(segment.file.string(), "", fmt::format("is being trained by {}", claim->owner),
                             "stop that first, or help it: the same command with --resume");
}

void expect_nobody_trains(const TrainOptions& options, const SegmentPlan& plan) {
    std::vector<voctree::ClipSegment> segments = plan.segments;
    if (voctree::is_segmented(options.clip())) {  // it may have been cut elsewhere
        const voctree::ClipIndex before = voctree::read_clip_index(options.clip());
        segments.insert(segments.end(), before.segments.begin(), before.segments.end());
    }
    expect_unclaimed(segments);
    for (const voctree::ClipSegment& segment : plan.segments)
        if (std::filesystem::exists(segment.file))
            throw InputError(segment.file.string(), "", "is there, but in no clip", "remove it");
}

void begin_segments(const TrainOptions& options, const SegmentPlan& plan) {
    if (options.is_part()) return;
    if (!options.live.metrics.empty()) std::filesystem::remove(options.live.metrics);
    std::filesystem::remove(training::rig_file(options.output));
    if (options.correction) training::write_rig_correction(options.output, *options.correction);
    voctree::write_clip_index(options.output, plan.clip);
}

}  // namespace neuvv::tools

// The plan of a clip in segments: where it is cut, and what each segment's run is given.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "tools/options.h"
#include "tools/train_run.h"
#include "training/checkpoint.h"
#include "training/claim.h"
#include "training/segments.h"
#include "voctree/clip_index.h"

namespace neuvv::tools {

namespace {

uint32_t longest_segment(const std::string& text, double fps) {
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
    const auto frames = static_cast<uint32_t>(times.size());
    for (uint32_t frame = 0; frame < frames && frames > 1; frame++)
        if (const double at = training::frame_of_time(times[frame], frames); at != frame)
            throw InputError("--segment", rig.file,
                             fmt::format("its {} times are not even: {} is that of frame {:.2f}, not {}", frames,
                                         times[frame], at, frame),
                             "give each frame f of n the time f / (n − 1), or train without --segment");
}

// The segments of the clip, and those that its folder holds, which may have been cut elsewhere.
std::vector<voctree::ClipSegment> segments_in_the_way(const TrainOptions& options, const voctree::ClipIndex& index) {
    std::vector<voctree::ClipSegment> segments = index.segments;
    if (!voctree::is_segmented(options.output)) return segments;
    const voctree::ClipIndex before = voctree::read_clip_index(options.output);
    segments.insert(segments.end(), before.segments.begin(), before.segments.end());
    return segments;
}

}  // namespace

voctree::ClipIndex plan_segments(const TrainOptions& options, const training::Rig& rig) {
    const std::vector<double> times = training::times_of(rig);
    const auto frames = static_cast<uint32_t>(times.size());
    expect_even_times(rig, times);
    voctree::ClipIndex index;
    if (options.settings.resume) {
        if (!voctree::is_segmented(options.output))
            throw InputError(options.output.string(), "", "has no clip.json: no run to go on with",
                             "train without --resume");
        if (options.settings.minutes == 0 && options.settings.steps == 0)
            throw InputError("--resume", options.output.string(), "is a clip in segments, whose budget is not known",
                             "repeat the command that began it, with its --minutes or --steps");
        index = voctree::read_clip_index(options.output);
        if (index.frames() != frames)
            throw InputError(options.output.string(), "",
                             fmt::format("has {} frames, {} has {}", index.frames(), options.dataset.string(), frames),
                             "resume with the data set that the run began with");
        if (!options.segment.empty() &&
            training::segment_lengths(frames, longest_segment(options.segment, rig.fps)).size() !=
                index.segments.size())
            throw InputError("--segment", options.segment,
                             fmt::format("{} has {} segments", options.output.string(), index.segments.size()),
                             "leave it out: a resumed clip keeps its segments");
        return index;
    }
    if (rig.fps > 0) index.fps = static_cast<float>(rig.fps);
    for (const uint32_t length : training::segment_lengths(frames, longest_segment(options.segment, rig.fps))) {
        const uint32_t first = index.segments.empty() ? 0 : index.frames();
        index.segments.push_back({options.output / voctree::segment_file_name(first), first, length});
    }
    return index;
}

TrainOptions options_of(const TrainOptions& clip, const voctree::ClipSegment& segment, uint32_t frames) {
    const double share = static_cast<double>(segment.frames) / frames;
    TrainOptions options = clip;
    options.output = segment.file;
    options.is_segment = true;
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

void expect_nobody_trains(const TrainOptions& options, const voctree::ClipIndex& index) {
    for (const voctree::ClipSegment& segment : segments_in_the_way(options, index))
        if (const auto claim = training::claim_of(segment.file))
            throw InputError(segment.file.string(), "", fmt::format("is being trained by {}", claim->owner),
                             "stop that first, or help it: the same command with --resume");
}

void begin_segments(const TrainOptions& options, const voctree::ClipIndex& index) {
    for (const voctree::ClipSegment& segment : segments_in_the_way(options, index))
        for (const std::filesystem::path& file : {segment.file, training::state_path(segment.file)})
            std::filesystem::remove(file);
    voctree::write_clip_index(options.output, index);
}

}  // namespace neuvv::tools

// A run of `neuvv train`: loads the images, trains one .nvv with a status line, and says what came of it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "tools/ranks.h"
#include "training/data/layouts/formats.h"
#include "training/data/segments.h"
#include "training/rig/rig_file.h"
#include "training/run/train.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

// What a training run shows of itself besides its status line: a preview image and a log of its numbers.
// In segments, the preview is of the one that is trained, and the log has the lines of all that this process trains; of
// several ranks, only the first shows itself.
struct LiveOptions {
    std::filesystem::path preview;  // PNG; empty: none
    std::filesystem::path metrics;  // JSON Lines; empty: none
};

// Some frames of a clip: those of a segment.
struct ClipPart {
    std::vector<double> times;  // of all frames of the clip
    uint32_t first = 0, count = 1;
    training::Rig of(const training::Rig& rig) const { return training::rig_of_frames(rig, times, first, count); }
};

struct TrainOptions {
    std::filesystem::path dataset, output;
    std::filesystem::path replaces;  // the clip whose place the output takes once it is whole (replacement.h); or empty
    std::string segment;             // the length of segments as the user wrote it; empty: the clip is one tree
    std::string from, to;  // the part of a segmented clip that is trained again, as the user wrote it; empty: all
    bool plan = false;     // of a segmented clip: only write the folder and its index
    std::optional<ClipPart> frames;  // of the segment that is trained; nothing: a whole clip
    std::string format = training::kAnyFormat, holdout;
    training::TrainSettings settings;
    double max_megabytes = 0, image_gigabytes = 0;
    bool uniform = false;
    std::string audio;  // the file with the clip's sound; mostly empty
    LiveOptions live;
    std::string refine, leave_out;
    std::optional<training::RigCorrection> correction;  // of a segment's rig, in place of a search of its own
    bool surroundings = false;                          // whether this run trains what stands around the performer
    std::string background;                             // "learn": what stands around the performer is learnt, too
    std::string init = "hull";                          // or "psi"
    double psi_minutes = 2;
    uint64_t psi_steps = 0;

    bool is_part() const { return !from.empty() || !to.empty(); }
    // The clip that the user named.
    const std::filesystem::path& clip() const { return replaces.empty() ? output : replaces; }
};

// How a run shows itself while it goes on.
struct RunView {
    bool quiet = false;  // prints results and errors alone
    // Called about once a second with how much of the run's budget is spent. Returns what stands before the status
    // line.
    std::function<std::string(double)> label;
};

// The parts of training that are named, with commas between them. Throws InputError for a name that there is not.
training::OptionalParts optional_parts_of(const std::string& names);

// Trains `rig`, or those frames of it that `options` name, into options.output. Returns whether the budget is spent;
// false where Ctrl-C ended the run. What was trained is saved in any case, unless that happened before the first step.
// Throws InputError and RuntimeFailure.
bool train_rig(const gpu::Device& device, const TrainOptions& options, const training::Rig& rig,
               const RunView& view = {});

// Searches the images of some frames for what all segments of a clip are to correct, and takes the time that this took
// off the budget in minutes of this process. Nothing where no image shows the performer, or where Ctrl-C stopped the
// search. Throws InputError and RuntimeFailure.
std::optional<training::RigCorrection> find_correction(const gpu::Device& device, TrainOptions& options,
                                                       const training::Rig& rig, const ClipPart& frames);

// What a run in segments trains.
struct SegmentPlan {
    voctree::ClipIndex clip;
    std::vector<voctree::ClipSegment> segments;  // that are trained: all, or those with frames of the part
    uint32_t frames() const;                     // of `segments` together
    uint32_t learnt_frames() const;              // the same, those of overlaps twice
};

// Those with frames of the part that --from and --to give; all where they give none. Throws InputError.
std::vector<voctree::ClipSegment> segments_of_part(const TrainOptions& options, const voctree::ClipIndex& index);

// The segments that --segment cuts; those that the clip has where a run is resumed, or a part is trained again. Throws
// InputError.
SegmentPlan plan_segments(const TrainOptions& options, const training::Rig& rig);

// Where the first of several ranks says for which start of the program (Ranks::job) it has begun the clip.
inline std::filesystem::path job_file(const std::filesystem::path& clip) {
    return clip / "job";
}

// Waits until the first rank has begun the clip, and returns where it is trained; empty where Ctrl-C came before.
// Throws RuntimeFailure where it does not begin.
std::filesystem::path place_of_first_rank(const std::filesystem::path& clip, const Ranks& ranks);

// Throws InputError where a process trains one of the segments.
void expect_unclaimed(const std::vector<voctree::ClipSegment>& segments);
// Throws InputError where a process trains a segment of the clip, or one of the plan's segments is there already.
void expect_nobody_trains(const TrainOptions& options, const SegmentPlan& plan);

// Where the whole clip is trained, writes the index, and rig.json where options have a correction, and removes the log
// of an earlier run. Throws RuntimeFailure.
void begin_segments(const TrainOptions& options, const SegmentPlan& plan);

// The share of all budgets that a segment gets: that of the frames that it learns, with its overlap, among all that the
// segments learn, so that each frame is learnt as well as others.
inline double budget_share(const voctree::ClipSegment& segment, uint32_t learnt_frames) {
    return static_cast<double>(segment.frames_of_file()) / learnt_frames;
}
// The options of a segment that gets this share.
TrainOptions options_of(const TrainOptions& clip, const voctree::ClipSegment& segment, double share);

// Where --refine asks for a search, finds what all segments correct, from the images of the segment nearest to the
// clip's centre that shows the performer. False where Ctrl-C stopped it. Throws InputError where no segment will do,
// and RuntimeFailure.
bool correct_clip(const gpu::Device& device, TrainOptions& options, const training::Rig& rig, const SegmentPlan& plan);

// Trains the segments of a clip, which become a folder (voctree/files/clip_index.h); the budget is shared by frames.
// Without TrainSettings::resume, the first rank begins with correct_clip and begin_segments, and sets it; with it,
// segments that are finished stay, and those that are not go on. Any number of processes may do this at once, ranks of
// one job or not: each segment is trained by the one that has its claim (training/run/claim.h), and that of a process
// that died is taken by another. Ranks wait until all segments are finished; a process that was started alone leaves to
// others what they train. A segment that cannot be trained is named, and the others are trained nevertheless; then
// throws InputError or RuntimeFailure.
void train_segments(const gpu::Device& device, TrainOptions& options, const training::Rig& rig, const SegmentPlan& plan,
                    const Ranks& ranks);

}  // namespace neuvv::tools

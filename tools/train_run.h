// A run of `neuvv train`: loads the images, trains one .nvv with a status line, and says what came of it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "tools/ranks.h"
#include "training/formats.h"
#include "training/train.h"
#include "voctree/clip_index.h"

namespace neuvv::tools {

// What a training run shows of itself besides its status line: a preview image and a log of its numbers.
struct LiveOptions {
    std::filesystem::path preview;  // PNG; empty: none
    std::filesystem::path metrics;  // JSON Lines; empty: none
};

struct TrainOptions {
    std::filesystem::path dataset, output;
    std::string segment;      // the length of segments as the user wrote it; empty: the clip is one tree
    std::string from, to;     // the part of a segmented clip that is trained again, as the user wrote it; empty: all
    bool plan = false;        // of a segmented clip: only write the folder and its index
    bool is_segment = false;  // whether it is a segment that is trained, in which the performer need not be
    std::string format = training::kAnyFormat;
    training::TrainSettings settings;
    double max_megabytes = 0, image_gigabytes = 0;
    bool uniform = false;
    LiveOptions live;
    std::string refine, leave_out;
    std::string init = "hull";  // or "psi"
    double psi_minutes = 2;
    uint64_t psi_steps = 0;

    bool is_part() const { return !from.empty() || !to.empty(); }
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

// Trains `rig`, the whole clip or a segment of it, into options.output. Returns whether the budget is spent; false
// where Ctrl-C ended the run. What was trained is saved in any case, unless that happened before the first step. Throws
// InputError and RuntimeFailure.
bool train_rig(const gpu::Device& device, const TrainOptions& options, const training::Rig& rig,
               const RunView& view = {});

// What a run in segments trains.
struct SegmentPlan {
    voctree::ClipIndex clip;
    std::vector<voctree::ClipSegment> segments;  // that are trained: all, or those with frames of the part
    uint32_t frames() const;                     // of `segments` together
};

// The segments that --segment cuts; those that the clip has where a run is resumed, or a part is trained again. Throws
// InputError.
SegmentPlan plan_segments(const TrainOptions& options, const training::Rig& rig);

// Where the first of several ranks says for which start of the program (Ranks::job) it has begun the clip.
inline std::filesystem::path job_file(const std::filesystem::path& clip) {
    return clip / "job";
}

// Throws InputError where a process trains a segment that begin_segments would remove.
void expect_nobody_trains(const TrainOptions& options, const SegmentPlan& plan);

// Removes the files of the plan's segments, and where the whole clip is trained, also what else its folder held; then
// it writes the index. Throws RuntimeFailure.
void begin_segments(const TrainOptions& options, const SegmentPlan& plan);

// The options of a segment, whose share of all budgets is that of its frames among `frames`.
TrainOptions options_of(const TrainOptions& clip, const voctree::ClipSegment& segment, uint32_t frames);

// Trains the segments of a clip, which become a folder (voctree/clip_index.h); the budget is shared by frames. Without
// TrainSettings::resume, the first rank begins with begin_segments; with it, segments that are finished stay, and those
// that are not go on. Any number of processes may do this at once, ranks of one job or not: each segment is trained by
// the one that has its claim (training/claim.h), and that of a process that died is taken by another. Ranks wait until
// all segments are finished; a process that was started alone leaves to others what they train. A segment that cannot
// be trained is named, and the others are trained nevertheless; then throws InputError or RuntimeFailure.
void train_segments(const gpu::Device& device, const TrainOptions& options, const training::Rig& rig,
                    const SegmentPlan& plan, const Ranks& ranks);

}  // namespace neuvv::tools

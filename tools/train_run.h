// A run of `neuvv train`: loads the images, trains one .nvv with a status line, and says what came of it.
#pragma once

#include <filesystem>
#include <string>

#include "gpu/device.h"
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
    bool is_segment = false;  // whether it is a segment that is trained, in which the performer need not be
    std::string format = training::kAnyFormat;
    training::TrainSettings settings;
    double max_megabytes = 0, image_gigabytes = 0;
    bool uniform = false;
    LiveOptions live;
    std::string refine;
    std::string init = "hull";  // or "psi"
    double psi_minutes = 2;
    uint64_t psi_steps = 0;
};

// Trains `rig`, the whole clip or a segment of it, into options.output. `label` stands before the status line. Returns
// whether the budget is spent; false where Ctrl-C ended the run. What was trained is saved in any case, unless that
// happened before the first step. Throws InputError and RuntimeFailure.
bool train_rig(const gpu::Device& device, const TrainOptions& options, const training::Rig& rig,
               const std::string& label = "");

// The segments of a clip that --segment cuts; of a resumed run those with which it began. Throws InputError.
voctree::ClipIndex plan_segments(const TrainOptions& options, const training::Rig& rig);

// Trains the segments of a clip, which become a folder (voctree/clip_index.h); the budget is shared by frames. Without
// TrainSettings::resume, what the folder held is removed first; with it, segments that are finished stay, and the one
// that is not goes on. A segment that cannot be trained is named, and the others are trained nevertheless; then throws
// InputError. Throws RuntimeFailure that names the segment's file.
void train_segments(const gpu::Device& device, const TrainOptions& options, const training::Rig& rig,
                    const voctree::ClipIndex& index);

}  // namespace neuvv::tools

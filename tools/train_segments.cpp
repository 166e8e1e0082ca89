#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/platform.h"
#include "tools/options.h"
#include "tools/train_run.h"
#include "training/checkpoint.h"
#include "training/segments.h"
#include "voctree/clip_index.h"

namespace neuvv::tools {

namespace {

// The longest segment in frames, of "4" or "0.5s".
uint32_t longest_segment(const std::string& text, double fps) {
    constexpr const char* kFix = "write for instance 8 for frames, or 0.5s for seconds";
    const bool seconds = text.ends_with('s');
    const double number = parse_numbers("--segment", seconds ? text.substr(0, text.size() - 1) : text, 1, kFix)[0];
    if (seconds && fps <= 0)
        throw InputError("--segment", text, "needs a frame rate, which the data set does not give", kFix);
    const double frames = std::round(seconds ? number * fps : number);
    if (frames < 1 || frames > voctree::kMaxClipFrames)
        throw InputError("--segment", text, fmt::format("is {} frames", frames), "give at least one frame");
    return static_cast<uint32_t>(frames);
}

// Removes the files of segments, so that those of an earlier run are not taken for this one's.
void remove_segments(const voctree::ClipIndex& index) {
    for (const voctree::ClipSegment& segment : index.segments)
        for (const std::filesystem::path& file : {segment.file, training::state_path(segment.file)})
            std::filesystem::remove(file);
}

// The settings of a segment, whose share of all budgets is that of its frames.
training::TrainSettings settings_of(const TrainOptions& options, double share) {
    training::TrainSettings settings = options.settings;
    if (settings.steps == 0 && settings.minutes == 0) settings.minutes = training::kDefaultMinutes;
    settings.minutes *= share;
    if (settings.steps > 0)
        settings.steps = std::max<uint64_t>(std::llround(static_cast<double>(settings.steps) * share), 1);
    settings.max_bytes = static_cast<uint64_t>(1e6 * options.max_megabytes * share);
    return settings;
}

}  // namespace

voctree::ClipIndex plan_segments(const TrainOptions& options, const training::Rig& rig) {
    const auto frames = static_cast<uint32_t>(training::times_of(rig).size());
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
        return index;
    }
    if (rig.fps > 0) index.fps = static_cast<float>(rig.fps);
    for (const uint32_t length : training::segment_lengths(frames, longest_segment(options.segment, rig.fps))) {
        const uint32_t first = index.segments.empty() ? 0 : index.frames();
        index.segments.push_back({options.output / voctree::segment_file_name(first), first, length});
    }
    return index;
}

void train_segments(const gpu::Device& device, const TrainOptions& options, const training::Rig& rig,
                    const voctree::ClipIndex& index) {
    const std::vector<double> times = training::times_of(rig);
    if (!options.settings.resume) {
        if (voctree::is_segmented(options.output)) remove_segments(voctree::read_clip_index(options.output));
        remove_segments(index);
        voctree::write_clip_index(options.output, index);
    }
    for (size_t i = 0; i < index.segments.size(); i++) {
        const voctree::ClipSegment& segment = index.segments[i];
        // A segment is finished when its checkpoint file is gone.
        const bool begun = std::filesystem::exists(training::state_path(segment.file));
        if (!begun && std::filesystem::exists(segment.file)) continue;
        fmt::print(stderr, "segment {} of {}: frames {} to {}\n", i + 1, index.segments.size(), segment.first,
                   segment.end() - 1);
        const training::Rig part_rig = training::rig_of_frames(rig, times, segment.first, segment.frames);
        TrainPart part{part_rig, segment.file,
                       settings_of(options, static_cast<double>(segment.frames) / index.frames())};
        part.label = fmt::format("segment {} of {} | ", i + 1, index.segments.size());
        part.settings.resume = begun;
        if (!train_part(device, options, part)) return;
        std::filesystem::remove(training::state_path(segment.file));
    }
    fmt::print("wrote {}: {} frames in {} segments\n", options.output.string(), index.frames(), index.segments.size());
}

}  // namespace neuvv::tools

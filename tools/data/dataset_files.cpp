#include "tools/data/dataset_files.h"

#include <fmt/format.h>

#include <cmath>

#include "base/platform.h"
#include "tools/options.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/unfinished_folder.h"
#include "training/data/write_dataset.h"
#include "training/tree/camera_check.h"

namespace neuvv::tools {

namespace {

void keep_frames(training::BothSplits& both, const std::string& frames) {
    if (frames.empty()) return;
    const FrameRange range = parse_frame_range(frames, static_cast<uint32_t>(training::frame_count(both)));
    if (range.first != std::floor(range.first) || range.last != std::floor(range.last))
        throw InputError("--frames", frames, "lies between two frames", "give whole numbers");
    training::keep_frames(both, static_cast<size_t>(range.first), static_cast<size_t>(range.last));
}

}  // namespace

void write_as_transforms(const std::filesystem::path& dataset, const std::string& format, const std::string& holdout,
                         const std::filesystem::path& output, const WrittenPart& part) {
    const UnfinishedDataset unfinished(output, dataset);
    training::BothSplits both = training::read_both_splits(dataset, format, holdout);
    if (holdout.empty()) training::add_validation(both, dataset, format);
    keep_frames(both, part.frames);
    for (size_t i = 0; i < both.rigs.size(); ++i)
        if (both.splits[i] == training::Split::kTrain) training::check_cameras(both.rigs[i]);
    catch_stop_signals();
    Progress progress("dataset");
    const training::WriteSummary wrote = training::write_dataset(
        both, unfinished.path(),
        [&](uint64_t done, uint64_t total) {
            progress.set_total(total);
            progress.update(done, "images");
            return done == total || !stop_requested();
        },
        part.reduction);
    progress.finish();
    if (!wrote.complete) throw RuntimeFailure("stopped before the end; nothing was written");
    unfinished.finish();
    say_remarks(wrote.remarks);
    if (!wrote.missing_split.empty())
        say("one split alone was written, the other cannot be read: {}\n", message_of(wrote.missing_split));
    tell("{}: {} images of {} train and {} test cameras{}, {}, {}\n", output.string(), wrote.images,
         wrote.train_cameras, wrote.test_cameras,
         wrote.val_cameras > 0 ? fmt::format(" and {} of the validation", wrote.val_cameras) : "",
         wrote.mattes ? "with mattes" : "without mattes",
         wrote.plates > 0 ? fmt::format("{} plates", wrote.plates) : "no plates");
}

}  // namespace neuvv::tools

#include "tools/train/replacement.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/file_lock.h"
#include "base/platform.h"
#include "tools/say.h"
#include "training/rig/rig_file.h"
#include "training/run/checkpoint.h"
#include "training/run/claim.h"
#include "voctree/files/clip_index.h"
#include "voctree/files/clip_sound.h"

namespace neuvv::tools {

namespace {

bool is_there(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::exists(file, ignored);
}

// The files of the output that hold what was trained, of what the run would train.
std::vector<std::filesystem::path> trained_before(const TrainOptions& options, bool in_segments) {
    std::vector<std::filesystem::path> files;
    if (!in_segments) files.push_back(options.output);
    if (in_segments && voctree::is_segmented(options.output))
        for (const auto& segment : segments_of_part(options, voctree::read_clip_index(options.output)))
            files.push_back(segment.file);
    std::erase_if(files, [](const auto& file) { return !is_there(file) && !is_there(training::state_path(file)); });
    return files;
}

// Moves a file over another one, if there is such a file; both may be the same, by two names.
void move_over(const std::filesystem::path& from, const std::filesystem::path& to) {
    if (!is_there(from)) return;
    std::error_code error;
    if (std::filesystem::equivalent(from, to, error))
        std::filesystem::remove(from);
    else
        replace_file(to, from);
}

// The same file by a second name, or a copy where the file system has no such names.
void link_or_copy(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code error;
    if (!is_there(from)) return;
    std::filesystem::create_hard_link(from, to, error);
    if (error) std::filesystem::copy_file(from, to);
}

// What a clip trained anew has beside its own: all segments that are not trained, and what they correct.
void copy_other_segments(const TrainOptions& options) {
    const voctree::ClipIndex index = voctree::read_clip_index(options.replaces);
    const std::vector<voctree::ClipSegment> part = segments_of_part(options, index);
    for (const voctree::ClipSegment& segment : index.segments) {
        if (segment.first >= part.front().first && segment.end() <= part.back().end()) continue;
        for (const std::filesystem::path& file : {segment.file, training::state_path(segment.file)})
            link_or_copy(file, options.output / file.filename());
    }
    link_or_copy(training::rig_file(options.replaces), training::rig_file(options.output));
    link_or_copy(voctree::index_file(options.replaces), voctree::index_file(options.output));
}

void move_segments(const std::filesystem::path& from, const std::filesystem::path& to) {
    const voctree::ClipIndex before = voctree::read_clip_index(to), index = voctree::read_clip_index(from);
    for (const voctree::ClipSegment& segment : index.segments) {
        const std::filesystem::path place = to / segment.file.filename();
        if (is_there(segment.file) && !is_there(training::state_path(segment.file)))
            std::filesystem::remove(training::state_path(place));
        move_over(segment.file, place);
        move_over(training::state_path(segment.file), training::state_path(place));
    }
    if (!is_there(training::rig_file(from))) std::filesystem::remove(training::rig_file(to));
    move_over(training::rig_file(from), training::rig_file(to));
    move_over(voctree::index_file(from), voctree::index_file(to));
    for (const voctree::ClipSegment& old : before.segments) {
        const bool stays = std::ranges::any_of(
            index.segments, [&](const auto& one) { return one.file.filename() == old.file.filename(); });
        for (const std::filesystem::path& file : {old.file, training::state_path(old.file)})
            if (!stays) std::filesystem::remove(file);
    }
}

// Several processes may find a clip in segments whole at the same time; they cannot train without locks. One tree can
// be trained where the file system has none.
std::optional<FileLock> lock_if_possible(const std::filesystem::path& file) {
    try {
        return FileLock(file);
    } catch (const RuntimeFailure&) {
        return std::nullopt;
    }
}

}  // namespace

std::filesystem::path replacement_of(const std::filesystem::path& clip) {
    if (voctree::is_segmented(clip)) return clip / "new.nvv";
    return clip.parent_path() / fmt::format(".{}.new.nvv", clip.stem().string());
}

bool has_replacement(const std::filesystem::path& clip) {
    const std::filesystem::path place = replacement_of(clip);
    return voctree::is_segmented(place) || is_there(training::state_path(place));
}

std::filesystem::path training_place(const TrainOptions& options, bool in_segments, bool overwrite) {
    const std::filesystem::path& clip = options.output;
    if (options.settings.resume) return has_replacement(clip) ? replacement_of(clip) : clip;
    const std::vector<std::filesystem::path> before = trained_before(options, in_segments);
    for (const std::filesystem::path& file : before)
        if (const auto claim = training::claim_of(file))
            throw InputError(file.string(), "", fmt::format("is being trained by {}", claim->owner),
                             in_segments ? "stop that first, or help it: the same command with --resume"
                                         : "wait for that, or choose another name");
    if (before.empty()) return clip;
    if (!overwrite)
        throw InputError("--output", clip.string(), "is there already",
                         "--resume trains on; --overwrite trains it anew, and replaces it once the new one is whole");
    return replacement_of(clip);
}

void begin_replacement(const TrainOptions& options) {
    const std::filesystem::path& place = options.output;
    try {
        if (voctree::is_segmented(options.replaces)) {
            if (voctree::is_segmented(place)) expect_unclaimed(voctree::read_clip_index(place).segments);
            std::filesystem::remove_all(place);
            std::filesystem::create_directory(place);
            if (options.is_part()) copy_other_segments(options);
        } else {
            for (const std::filesystem::path& file : {place, training::state_path(place), voctree::sound_file(place)})
                std::filesystem::remove(file);
        }
        say("{} is trained anew as {}\n", options.replaces.string(), place.string());
    } catch (const std::filesystem::filesystem_error& error) {
        throw RuntimeFailure(fmt::format("{}: cannot be begun: {}", place.string(), error.code().message()));
    }
}

bool is_replaced(const TrainOptions& options) {
    return !options.replaces.empty() && !voctree::is_segmented(options.output);
}

void finish_replacement(const TrainOptions& options) {
    const std::filesystem::path &place = options.output, &clip = options.replaces;
    const std::filesystem::path lock = place.string() + ".replace";
    try {
        const std::optional<FileLock> only = lock_if_possible(lock);
        const bool in_segments = voctree::is_segmented(place);
        if (in_segments) move_segments(place, clip);
        if (!in_segments && is_there(place)) {
            move_over(place, clip);
            move_over(training::state_path(place), training::state_path(clip));
        }
        move_over(voctree::sound_file(place), voctree::sound_file(clip));
        if (in_segments) std::filesystem::remove_all(place);
        if (only) std::filesystem::remove(lock);
    } catch (const std::filesystem::filesystem_error& error) {
        throw RuntimeFailure(fmt::format("{}: cannot be replaced: {}", clip.string(), error.code().message()));
    }
}

}  // namespace neuvv::tools

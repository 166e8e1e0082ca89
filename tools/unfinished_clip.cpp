#include "tools/unfinished_clip.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/platform.h"
#include "tools/results.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

namespace {

// A name beside the clip that is free: one may be there, left by a process that was killed.
std::filesystem::path name_of_replaced(const std::filesystem::path& clip) {
    std::filesystem::path name = clip.string() + ".replaced";
    for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(name)); ++i)
        name = fmt::format("{}.replaced{}", clip.string(), i);
    return name;
}

// The two change places at once, and the old clip is removed; where the file system cannot do that, the old one steps
// aside, and returns where it cannot be replaced.
void replace_clip(const std::filesystem::path& made, const std::filesystem::path& clip, std::error_code& error) {
    std::error_code ignored;
    if (exchange_files(made, clip)) {
        std::filesystem::remove_all(made, ignored);
        return;
    }
    const std::filesystem::path old = name_of_replaced(clip);
    std::filesystem::rename(clip, old, error);
    if (error) return;
    std::filesystem::rename(made, clip, error);
    if (error)
        std::filesystem::rename(old, clip, ignored);
    else
        std::filesystem::remove_all(old, ignored);
}

}  // namespace

UnfinishedClip::UnfinishedClip(const std::filesystem::path& output)
    : output_(voctree::clip_path(output)), folder_(output_.string() + ".unfinished") {
    if (output_.extension() != ".nvv")
        throw InputError("--output", output_.string(), "is no name of a clip", "write for instance show.nvv");
    if (std::filesystem::exists(output_)) expect_replaceable("--output", output_);
    prepare_result("--output", std::filesystem::is_directory(output_) ? voctree::index_file(output_) : output_);
    std::error_code error;
    if (std::filesystem::create_directory(folder_, error)) {
        lock_ = FileLock::try_lock(lock());
        return;
    }
    if (!error && take_abandoned()) return;
    if (error) throw InputError("--output", folder_.string(), "cannot be made: " + error.message());
    throw InputError("--output", folder_.string(),
                     "is there already: the clip is being written, or the folder is somebody's",
                     "wait for that, or remove it");
}

// Only what has a lock in it is a folder of this class.
bool UnfinishedClip::take_abandoned() {
    std::error_code error;
    if (!std::filesystem::is_directory(std::filesystem::symlink_status(folder_, error)) ||
        !std::filesystem::is_regular_file(std::filesystem::symlink_status(lock(), error)))
        return false;
    lock_ = FileLock::try_lock(lock());
    if (!lock_) return false;
    for (const auto& entry : std::filesystem::directory_iterator(folder_, error))
        if (entry.path() != lock()) std::filesystem::remove_all(entry.path(), error);
    return true;
}

UnfinishedClip::~UnfinishedClip() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

void UnfinishedClip::finish(const std::filesystem::path& made) const {
    std::error_code error;
    std::filesystem::remove(lock(), error);
    // A file takes the place of a file at once.
    const bool replaces = std::filesystem::exists(output_) &&
                          (std::filesystem::is_directory(output_) || std::filesystem::is_directory(made));
    if (replaces)
        replace_clip(made, output_, error);
    else
        std::filesystem::rename(made, output_, error);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot be written: {}", output_.string(), error.message()));
}

}  // namespace neuvv::tools

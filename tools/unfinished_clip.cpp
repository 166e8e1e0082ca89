#include "tools/unfinished_clip.h"

#include <fmt/format.h>

#include "base/error.h"
#include "tools/results.h"
#include "voctree/clip_index.h"

namespace neuvv::tools {

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
    const std::filesystem::path old = output_.string() + ".replaced";
    // A file takes the place of a file at once.
    const bool replaces = std::filesystem::exists(output_) &&
                          (std::filesystem::is_directory(output_) || std::filesystem::is_directory(made));
    if (replaces) std::filesystem::rename(output_, old, error);
    if (!error) std::filesystem::rename(made, output_, error);
    if (replaces && error) std::filesystem::rename(old, output_);
    if (replaces && !error) std::filesystem::remove_all(old);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot be written: {}", output_.string(), error.message()));
}

}  // namespace neuvv::tools

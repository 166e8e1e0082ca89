// A clip that is being written: it gets its name when all of it is there.
#pragma once

#include <filesystem>
#include <optional>

#include "base/file_lock.h"

namespace neuvv::tools {

// A folder beside the clip, in which a file or a folder is made that becomes the clip. It is removed at the end. A lock
// in it tells that its process lives: what a killed one left is replaced by the next.
class UnfinishedClip {
  public:
    // Throws InputError where there is something of the clip's name already, unless --overwrite says that it is
    // replaced, or of the folder's name, or where nothing can be written there.
    explicit UnfinishedClip(const std::filesystem::path& output);
    UnfinishedClip(const UnfinishedClip&) = delete;
    UnfinishedClip& operator=(const UnfinishedClip&) = delete;
    ~UnfinishedClip();

    const std::filesystem::path& folder() const { return folder_; }
    // Gives the clip's name to `made`, a file in the folder or the folder itself. Throws RuntimeFailure.
    void finish(const std::filesystem::path& made) const;

  private:
    std::filesystem::path lock() const { return folder_ / "lock"; }
    bool take_abandoned();
    std::filesystem::path output_, folder_;
    std::optional<FileLock> lock_;
};

}  // namespace neuvv::tools

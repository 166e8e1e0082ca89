// A folder of a capture, or of views of a clip, that is being made: its files get their places when all of them are
// there.
#pragma once

#include <filesystem>

namespace neuvv::tools {

// The folder `unfinished` in the folder of the capture. It is removed at the end.
class UnfinishedFolder {
  public:
    // Throws InputError where the folder holds a file of a capture, other images, plates or key points, unless
    // --overwrite says that it is replaced.
    explicit UnfinishedFolder(std::filesystem::path folder);
    UnfinishedFolder(const UnfinishedFolder&) = delete;
    UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;
    ~UnfinishedFolder();

    std::filesystem::path path() const { return folder_ / "unfinished"; }
    // Removes the files of an earlier capture, and moves those of this one into their places. Throws RuntimeFailure.
    void finish() const;

  private:
    std::filesystem::path folder_;
};

}  // namespace neuvv::tools

// Folders whose files get their places when all of them are there.
#pragma once

#include <filesystem>
#include <optional>

namespace neuvv::tools {

// The folder `unfinished` in another one. It is removed at the end.
class UnfinishedFiles {
  public:
    // Removes what a program that was killed left there. Throws InputError where the folder cannot be made.
    explicit UnfinishedFiles(std::filesystem::path folder);
    UnfinishedFiles(const UnfinishedFiles&) = delete;
    UnfinishedFiles& operator=(const UnfinishedFiles&) = delete;
    ~UnfinishedFiles();

    std::filesystem::path path() const { return folder_ / "unfinished"; }
    // Moves the files into the folder, over those of the same names. Throws RuntimeFailure.
    void finish() const;

  private:
    std::filesystem::path folder_;
};

// A capture, or views of a clip, that are being made.
class UnfinishedFolder {
  public:
    // Throws InputError where the folder holds a file of a capture, other images, plates, key points or mattes, unless
    // --overwrite says that it is replaced.
    explicit UnfinishedFolder(std::filesystem::path folder);

    std::filesystem::path path() const { return files_->path(); }
    // Removes the files of an earlier capture, mattes of its images included, and moves those of this one into their
    // places. Throws RuntimeFailure.
    void finish() const;

  private:
    std::filesystem::path folder_;
    std::optional<UnfinishedFiles> files_;  // once it is known that the folder may be written
};

// A data set that is written (training/data/write_dataset.h).
class UnfinishedDataset {
  public:
    // Throws InputError where the folder is that of the data set or holds it, where it holds other files than such a
    // data set, and where it holds one, unless --overwrite says that it is replaced.
    UnfinishedDataset(std::filesystem::path folder, const std::filesystem::path& from);

    std::filesystem::path path() const { return files_->path(); }
    // Removes an earlier data set, and moves this one into its place. Throws RuntimeFailure.
    void finish() const;

  private:
    std::filesystem::path folder_;
    std::optional<UnfinishedFiles> files_;
};

}  // namespace neuvv::tools

// How files are written: beside their place, under a name that nobody can guess, until they are complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace neuvv {

// A file that is written beside its place. At any moment, power cuts included, the path has either the old or the new
// content, and any number of processes may write the same path at the same time: the last to finish wins. Where the
// path is a link, the link stays and its target is replaced. A file that is replaced keeps its permissions, and its
// owner where the system allows it. All functions throw RuntimeFailure with the path.
//
// What a killed process leaves has a hidden name; it is removed by the next process that writes into the folder, which
// knows by a lock that nobody writes it any more.
class NewFile {
  public:
    // Throws also where the path is a folder, a device or write-protected.
    explicit NewFile(const std::filesystem::path& path);
    NewFile(NewFile&& other) noexcept;
    NewFile& operator=(NewFile&& other) noexcept;
    ~NewFile();  // without finish(), what was written is removed

    const std::filesystem::path& path() const { return path_; }  // with links followed
    void write(const void* data, size_t bytes);
    // Writes over what is there already.
    void write_at(uint64_t offset, const void* data, size_t bytes);
    // Under this name a library may open the file to write or read, while this object lives: no other file can take the
    // name's place.
    std::filesystem::path name_to_open() const;

    enum class Sync { kNo, kYes };
    // The file gets its name. Without a sync, a power cut may leave a part of it under that name.
    void finish(Sync sync = Sync::kYes);

  private:
    void create();
    void discard() noexcept;
    std::filesystem::path path_, temporary_;
    int descriptor_ = -1;
};

// Writes a whole NewFile: `write` gets a sink, which it calls with consecutive parts of the content.
using ByteSink = std::function<void(const void* data, size_t bytes)>;
void write_file_atomically(const std::filesystem::path& path, const std::function<void(const ByteSink&)>& write);

// The last part of that, for a file that has lain elsewhere on the same file system: `finished` is synced and becomes
// `path`. Throws RuntimeFailure with the path.
void replace_file(const std::filesystem::path& path, const std::filesystem::path& finished);

// The path to which a file with this path would be written: the target of a link, whether that exists or not, else the
// path itself.
std::filesystem::path link_target(std::filesystem::path path);

// Why a file cannot be replaced, with links followed: devices, pipes, folders, and what is write-protected. Empty where
// the path is free or a regular file that may be written.
std::string why_not_replaced(const std::filesystem::path& file);

}  // namespace neuvv

// File stamps, which show whether a file on the disk has changed.
#pragma once

#include <cstdint>
#include <filesystem>

namespace neuvv {

// Two versions of a file have different stamps, unless they have the same size and were written within one step of the
// file system's clock.
struct FileStamp {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type written{};
    bool operator==(const FileStamp&) const = default;
};

// The stamp of a file; all zero where the file is missing. It should be taken before the file is read, so that a change
// during the reading is noticed later.
inline FileStamp stamp_of(const std::filesystem::path& path) {
    std::error_code problem;
    const std::uintmax_t bytes = std::filesystem::file_size(path, problem);
    if (problem) return {};
    const std::filesystem::file_time_type written = std::filesystem::last_write_time(path, problem);
    return problem ? FileStamp{} : FileStamp{bytes, written};
}

}  // namespace neuvv

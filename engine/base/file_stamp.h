// File stamp: whether a file on the disk is another than it was.
#pragma once

#include <cstdint>
#include <filesystem>

namespace neuvv {

// Two versions of one file differ in this, unless they are as large and were written within the file system's clock.
struct FileStamp {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type written{};
    bool operator==(const FileStamp&) const = default;
};

// Of a file that is not there: all zero. Taken before the file is read, so that a change meanwhile is seen later.
inline FileStamp stamp_of(const std::filesystem::path& path) {
    std::error_code problem;
    const std::uintmax_t bytes = std::filesystem::file_size(path, problem);
    if (problem) return {};
    const std::filesystem::file_time_type written = std::filesystem::last_write_time(path, problem);
    return problem ? FileStamp{} : FileStamp{bytes, written};
}

}  // namespace neuvv

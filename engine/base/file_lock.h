// Locks on files, by which a process can tell whether another one still runs. These are system calls, as those of
// platform.h: a port to another system replaces both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>

namespace neuvv {

int64_t process_id();

// A lock on a file. It ends with this object or with its process, however the process ends.
class FileLock {
  public:
    FileLock() = default;
    // Creates the file where it is missing, and waits until nobody else has the lock. Throws RuntimeFailure.
    explicit FileLock(const std::filesystem::path& file);
    FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileLock& operator=(FileLock&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~FileLock();

  private:
    int descriptor_ = -1;
};

// Whether any process, including this one, has a lock on the file; false where the file does not exist.
bool is_file_locked(const std::filesystem::path& file);

}  // namespace neuvv

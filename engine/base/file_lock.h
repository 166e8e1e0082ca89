// Which processes live, told by the locks that they hold. With platform.h, what a port to another system replaces.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>

namespace neuvv {

int64_t process_id();

// A lock on a file, which ends with this object or with its process, however that ends.
class FileLock {
  public:
    FileLock() = default;
    // Makes the file if need be, and waits until nobody else holds it. Throws RuntimeFailure.
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

// Whether anyone, this process included, holds a lock on the file; false where it is not there.
bool is_file_locked(const std::filesystem::path& file);

}  // namespace neuvv

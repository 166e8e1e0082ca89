// Locks on files, by which a process can tell whether another one still runs. These are system calls, as those of
// platform.h: a port to another system replaces both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace neuvv {

int64_t process_id();
// The name of this machine in its network; empty where it has none.
std::string host_name();

// A lock on a file, also on a network's file system that supports locks. It ends with this object or with its process,
// however the process ends.
class FileLock {
  public:
    FileLock() = default;
    // Creates the file where it is missing, and waits until nobody else has the lock. Throws RuntimeFailure.
    explicit FileLock(const std::filesystem::path& file);
    // The same, but returns nothing where somebody else has the lock.
    static std::optional<FileLock> try_lock(const std::filesystem::path& file);
    FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileLock& operator=(FileLock&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~FileLock();

    // Replaces the file's content, which others may read at any time. Returns whether it could be written.
    bool write(std::string_view text) const;

  private:
    enum class Wait { kNo, kYes };
    bool lock(const std::filesystem::path& file, Wait wait);
    int descriptor_ = -1;
};

// Held by whoever reads a file, changes it and writes it again, so that no change of another process is lost. It is a
// lock on a hidden file beside it, ".NAME.lock", which is there only meanwhile. Where the file system has no locks or
// the folder takes no file, it keeps nobody from anything.
class EditLock {
  public:
    // Waits until nobody else has it. `waiting` is called once where that takes a second. Throws RuntimeFailure where a
    // signal asks to stop meanwhile.
    explicit EditLock(const std::filesystem::path& file, const std::function<void()>& waiting = {});
    EditLock(const EditLock&) = delete;
    EditLock& operator=(const EditLock&) = delete;
    ~EditLock();

  private:
    std::filesystem::path path_;
    std::optional<FileLock> lock_;
};

// Whether any process, including this one, has a lock on the file; false where the file does not exist. The question
// itself keeps nobody from locking.
bool is_file_locked(const std::filesystem::path& file);

}  // namespace neuvv

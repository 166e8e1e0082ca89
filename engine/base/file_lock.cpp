#include "base/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace neuvv {

int64_t process_id() {
    return getpid();
}

FileLock::FileLock(const std::filesystem::path& file)
    : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    int failed = descriptor_ < 0 ? -1 : flock(descriptor_, LOCK_EX);
    while (failed && errno == EINTR && descriptor_ >= 0) failed = flock(descriptor_, LOCK_EX);
    if (!failed) return;
    const int reason = errno;
    if (descriptor_ >= 0) close(descriptor_);
    throw RuntimeFailure(fmt::format("{}: cannot be locked: {}", file.string(), std::strerror(reason)));
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

bool is_file_locked(const std::filesystem::path& file) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    if (descriptor < 0) return false;
    const bool locked = flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    close(descriptor);
    return locked;
}

}  // namespace neuvv

#include "base/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv {

namespace {

// The whole file. Such a lock belongs to an open file, so that two objects of one process exclude each other, too.
struct flock whole_file() {
    struct flock range = {};
    range.l_type = F_WRLCK;
    range.l_whence = SEEK_SET;
    return range;
}

// Whether the path still leads to the open file, which somebody may have removed.
bool is_at(int descriptor, const std::filesystem::path& file) {
    struct stat open_file = {}, at_path = {};
    return fstat(descriptor, &open_file) == 0 && stat(file.c_str(), &at_path) == 0 &&
           open_file.st_dev == at_path.st_dev && open_file.st_ino == at_path.st_ino;
}

// Whoever may write into the folder of a new lock's file may lock it, too, whatever the umask says: the users of a
// group's folder keep each other waiting.
void share_with_folder(int descriptor, const std::filesystem::path& file) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    struct stat of_folder = {}, of_file = {};
    if (stat(folder.c_str(), &of_folder) != 0 || fstat(descriptor, &of_file) != 0) return;
    const bool group_is_kept = fchown(descriptor, of_folder.st_uid, of_folder.st_gid) == 0 ||
                               fchown(descriptor, static_cast<uid_t>(-1), of_folder.st_gid) == 0 ||
                               of_file.st_gid == of_folder.st_gid;
    mode_t mode = of_file.st_mode & 0777;
    if (group_is_kept && of_folder.st_mode & S_IWGRP) mode |= S_IRGRP | S_IWGRP;
    if (of_folder.st_mode & S_IWOTH) mode |= S_IROTH | S_IWOTH;
    if (fchmod(descriptor, mode) != 0) return;  // a file system without permissions
}

// Opens the file, or creates it. The system may refuse to create what is there and belongs to somebody else, so that
// these are two calls.
int open_or_create(const std::filesystem::path& file) {
    constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
    for (;;) {
        int descriptor = open(file.c_str(), kFlags);
        if (descriptor >= 0 || errno != ENOENT) return descriptor;
        descriptor = open(file.c_str(), kFlags | O_CREAT | O_EXCL, 0666);
        if (descriptor >= 0) share_with_folder(descriptor, file);
        if (descriptor >= 0 || errno != EEXIST) return descriptor;
    }
}

// Creates the file where it is missing. Links are not followed, and no file is taken that has another name, too, as
// what is written would replace that file's content.
int open_for_lock(const std::filesystem::path& file) {
    const int descriptor = open_or_create(file);
    struct stat what = {};
    if (descriptor < 0 || (fstat(descriptor, &what) == 0 && S_ISREG(what.st_mode) && what.st_nlink <= 1))
        return descriptor;
    close(descriptor);
    errno = EINVAL;
    return -1;
}

}  // namespace

int64_t process_id() {
    return getpid();
}

std::string host_name() {
    char name[HOST_NAME_MAX + 1] = {};
    return gethostname(name, sizeof(name) - 1) == 0 ? name : "";
}

FileLock::FileLock(const std::filesystem::path& file) {
    lock(file, Wait::kYes);
}

std::optional<FileLock> FileLock::try_lock(const std::filesystem::path& file) {
    FileLock result;
    if (!result.lock(file, Wait::kNo)) return std::nullopt;
    return result;
}

bool FileLock::lock(const std::filesystem::path& file, Wait wait) {
    for (;;) {
        FileLock opened;
        opened.descriptor_ = open_for_lock(file);
        struct flock range = whole_file();
        int failed = opened.descriptor_ < 0 ? -1 : 0;
        while (opened.descriptor_ >= 0) {
            failed = fcntl(opened.descriptor_, wait == Wait::kYes ? F_OFD_SETLKW : F_OFD_SETLK, &range);
            if (!failed || errno != EINTR) break;
        }
        if (failed && wait == Wait::kNo && (errno == EAGAIN || errno == EACCES) && opened.descriptor_ >= 0)
            return false;
        if (failed && errno == ESTALE) continue;  // another machine has removed the file
        if (failed) throw RuntimeFailure(fmt::format("{}: cannot be locked: {}", file.string(), std::strerror(errno)));
        if (!is_at(opened.descriptor_, file)) continue;
        *this = std::move(opened);
        return true;
    }
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

bool FileLock::write(std::string_view text) const {
    return pwrite(descriptor_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()) &&
           ftruncate(descriptor_, static_cast<off_t>(text.size())) == 0;
}

namespace {

constexpr size_t kMostOfLockName = 200;  // bytes; a name has at most 255
constexpr std::chrono::milliseconds kAskAgain{20}, kSayThatItWaits{1000};
constexpr int kMostFailures = 2;

std::filesystem::path edit_lock_path(const std::filesystem::path& file) {
    const std::filesystem::path target = link_target(file);
    return target.parent_path() / ("." + target.filename().string().substr(0, kMostOfLockName) + ".lock");
}

}  // namespace

EditLock::EditLock(const std::filesystem::path& file, const std::function<void()>& waiting)
    : path_(edit_lock_path(file)) {
    std::chrono::milliseconds waited{0};
    for (int failures = 0;; waited += kAskAgain) {
        try {
            if ((lock_ = FileLock::try_lock(path_))) return;
        } catch (const RuntimeFailure&) {
            // It may be the file of another user, who has the lock or has just removed it; else there are no locks
            // here.
            if (!is_file_locked(path_) && ++failures == kMostFailures) return;
        }
        if (waited == kSayThatItWaits && waiting) waiting();
        if (stop_requested())
            throw RuntimeFailure(fmt::format("{}: stopped while another program was editing it", file.string()));
        std::this_thread::sleep_for(kAskAgain);
    }
}

// The file is removed while it is locked, so that nobody's lock on a file that is gone counts (FileLock).
EditLock::~EditLock() {
    std::error_code ignored;
    if (lock_) std::filesystem::remove(path_, ignored);
}

bool is_file_locked(const std::filesystem::path& file) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    if (descriptor < 0) return false;
    struct flock range = whole_file();
    const bool locked = fcntl(descriptor, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
    close(descriptor);
    return locked;
}

}  // namespace neuvv

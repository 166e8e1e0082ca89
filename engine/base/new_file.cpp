#include "base/new_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <set>
#include <string_view>
#include <utility>

#include "base/descriptor.h"
#include "base/error.h"

namespace neuvv {

namespace {

constexpr int kMaxLinks = 40;  // as many as Linux follows
constexpr std::string_view kMark = ".neuvv-";
constexpr size_t kRandomLetters = 16;  // 80 bits
constexpr size_t kMostOfName = 200;    // bytes; a name has at most 255
constexpr mode_t kNewFileMode = 0666;  // less what the umask takes
constexpr mode_t kOwnFileMode = 0600;  // until the file gets the owner and the permissions of the one it replaces
constexpr int kMostRefusedLocks = 100;
constexpr int kNoLinks = O_CLOEXEC | O_NOFOLLOW;

std::string random_letters() {
    constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz234567";
    unsigned char bytes[kRandomLetters];
    if (getrandom(bytes, sizeof bytes, 0) != static_cast<ssize_t>(sizeof bytes))
        throw RuntimeFailure(fmt::format("the system gives no random numbers: {}", std::strerror(errno)));
    std::string letters;
    for (const unsigned char byte : bytes) letters += kLetters[byte % kLetters.size()];
    return letters;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

// "show.mp4" becomes ".show.mp4.neuvv-k3vq…".
std::filesystem::path temporary_name(const std::filesystem::path& path) {
    const std::string name = path.filename().string().substr(0, kMostOfName);
    return path.parent_path() / fmt::format(".{}{}{}", name, kMark, random_letters());
}
bool is_temporary_name(std::string_view name) {
    return name.size() > kMark.size() + kRandomLetters && name.front() == '.' &&
           name.substr(name.size() - kRandomLetters - kMark.size()).starts_with(kMark);
}

enum class Lock { kTaken, kOfAnother, kNone };  // kNone: the file system has no locks

// A lock that belongs to the open file, so that it ends with its process, however that ends, and is seen by other
// containers of the machine and by other machines. Where the file system has no locks, files are not locked, and none
// are taken for abandoned.
Lock lock(int descriptor) {
    struct flock whole = {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    if (fcntl(descriptor, F_OFD_SETLK, &whole) == 0) return Lock::kTaken;
    return errno == EAGAIN || errno == EACCES ? Lock::kOfAnother : Lock::kNone;
}

void remove_if_abandoned(const std::filesystem::path& file) {
    const Descriptor opened(open(file.c_str(), O_RDWR | O_NONBLOCK | kNoLinks));
    struct stat what = {};
    if (opened.number < 0 || fstat(opened.number, &what) != 0 || !S_ISREG(what.st_mode)) return;
    if (lock(opened.number) == Lock::kTaken) unlink(file.c_str());
}

// Once a process for each folder, as reading a folder of many images takes long.
void remove_abandoned(const std::filesystem::path& folder) {
    static std::mutex mutex;
    // It lives as long as the process: other objects with static storage write files when they end.
    static auto& looked_into = *new std::set<std::filesystem::path>;
    std::error_code error;
    {
        const std::lock_guard guard(mutex);
        if (!looked_into.insert(std::filesystem::absolute(folder, error)).second) return;
    }
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (is_temporary_name(at->path().filename().string())) remove_if_abandoned(at->path());
}

// Gives a new file the permissions and the owner of the file that it replaces. Where the group cannot be kept, it gets
// what all others have, so that no other group may do more than before.
void take_over_permissions(int descriptor, const std::filesystem::path& replaced) {
    struct stat old = {}, now = {};
    if (stat(replaced.c_str(), &old) != 0 || fstat(descriptor, &now) != 0) return;
    bool group_is_kept = old.st_gid == now.st_gid;
    if (!group_is_kept || old.st_uid != now.st_uid)
        group_is_kept = fchown(descriptor, old.st_uid, old.st_gid) == 0 ||
                        fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) == 0 || group_is_kept;
    mode_t mode = old.st_mode & 0777;
    if (!group_is_kept) mode = (mode & 0707) | (mode & 0007) << 3;
    if (fchmod(descriptor, mode) != 0) return;  // a file system without permissions
}

// An open file, which lies at `from`, becomes `path`.
void put_in_place(int descriptor, const std::filesystem::path& from, const std::filesystem::path& path,
                  NewFile::Sync sync) {
    if (const std::string why = why_not_replaced(path); !why.empty())
        throw RuntimeFailure(fmt::format("{}: {}", path.string(), why));
    take_over_permissions(descriptor, path);
    if (sync == NewFile::Sync::kYes && fsync(descriptor) != 0) fail_by_errno(path, "sync");
    if (rename(from.c_str(), path.c_str()) != 0) fail_by_errno(path, "replace");
    if (sync == NewFile::Sync::kNo) return;
    const Descriptor folder(open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (folder.number >= 0) fsync(folder.number);  // best effort: some file systems refuse to sync folders
}

}  // namespace

NewFile::NewFile(const std::filesystem::path& path) : path_(link_target(path)) {
    if (const std::string why = why_not_replaced(path_); !why.empty())
        throw RuntimeFailure(fmt::format("{}: {}", path.string(), why));
    remove_abandoned(folder_of(path_));
    create();
}

// Between the creation and the lock, another process may take the file for abandoned, lock it and remove it: then it
// gets another name. A file system that refuses every lock so is one without locks.
void NewFile::create() {
    std::error_code error;
    const mode_t mode = std::filesystem::exists(path_, error) ? kOwnFileMode : kNewFileMode;
    for (int refused = 0;;) {
        temporary_ = temporary_name(path_);
        descriptor_ = open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | kNoLinks, mode);
        if (descriptor_ < 0 && errno == EEXIST) continue;
        if (descriptor_ < 0) fail_by_errno(path_, "create a file beside it");
        const bool is_mine = lock(descriptor_) != Lock::kOfAnother || ++refused == kMostRefusedLocks;
        struct stat what = {};
        if (is_mine && fstat(descriptor_, &what) == 0 && what.st_nlink > 0) return;
        discard();
    }
}

NewFile::NewFile(NewFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

NewFile& NewFile::operator=(NewFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(temporary_, other.temporary_);
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

NewFile::~NewFile() {
    discard();
}

void NewFile::discard() noexcept {
    if (descriptor_ < 0) return;
    unlink(temporary_.c_str());
    close(std::exchange(descriptor_, -1));
}

void NewFile::write(const void* data, size_t bytes) {
    const char* at = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t written = ::write(descriptor_, at, bytes);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_by_errno(path_, "write");
        at += written;
        bytes -= static_cast<size_t>(written);
    }
}

void NewFile::write_at(uint64_t offset, const void* data, size_t bytes) {
    const char* at = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t written = pwrite(descriptor_, at, bytes, static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail_by_errno(path_, "write");
        at += written;
        offset += static_cast<uint64_t>(written);
        bytes -= static_cast<size_t>(written);
    }
}

std::filesystem::path NewFile::name_to_open() const {
    return fmt::format("/proc/self/fd/{}", descriptor_);
}

void NewFile::finish(Sync sync) {
    put_in_place(descriptor_, temporary_, path_, sync);
    if (close(std::exchange(descriptor_, -1)) != 0) fail_by_errno(path_, "write");
}

void write_file_atomically(const std::filesystem::path& path, const std::function<void(const ByteSink&)>& write) {
    NewFile file(path);
    write([&](const void* data, size_t bytes) { file.write(data, bytes); });
    file.finish();
}

void replace_file(const std::filesystem::path& path, const std::filesystem::path& finished) {
    const Descriptor file(open(finished.c_str(), O_RDONLY | kNoLinks));
    if (file.number < 0) fail_by_errno(finished, "sync");
    put_in_place(file.number, finished, path, NewFile::Sync::kYes);
}

// A folder's path may end with a slash, behind which there is no name.
std::filesystem::path link_target(std::filesystem::path path) {
    if (!path.has_filename()) path = path.parent_path();
    std::error_code error;
    for (int hops = 0; hops < kMaxLinks && std::filesystem::is_symlink(path, error); ++hops)
        path = path.parent_path() / std::filesystem::read_symlink(path, error);
    return path;
}

// To the superuser no file is write-protected, but one that nobody may write is meant to stay.
std::string why_not_replaced(const std::filesystem::path& file) {
    struct stat what = {};
    if (stat(file.c_str(), &what) != 0) return {};
    if (!S_ISREG(what.st_mode)) return "is no regular file to write to";
    const bool writable = (what.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) != 0 && access(file.c_str(), W_OK) == 0;
    return writable ? "" : "is write-protected; name another file, or allow writing it (chmod u+w)";
}

}  // namespace neuvv

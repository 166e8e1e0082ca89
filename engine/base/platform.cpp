#include "base/platform.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "base/error.h"

namespace neuvv {

namespace {

struct FileDescriptor {
    int fd = -1;
    explicit FileDescriptor(int descriptor) : fd(descriptor) {}
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    ~FileDescriptor() {
        if (fd >= 0) close(fd);
    }
};

[[noreturn]] void fail_write(const std::filesystem::path& path, const char* what) {
    throw RuntimeFailure(fmt::format("{}: cannot {}: {}", path.string(), what, std::strerror(errno)));
}

volatile std::sig_atomic_t g_stop = 0;

void on_stop_signal(int signal) {
    if (g_stop) {  // asked twice: stop at once
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    g_stop = 1;
}

}  // namespace

void write_file_atomically(const std::filesystem::path& path, const std::function<void(const ByteSink&)>& write) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    const std::filesystem::path temporary = path.string() + fmt::format(".tmp{}", getpid());
    try {
        FileDescriptor file(open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
        if (file.fd < 0) fail_write(temporary, "create");
        write([&](const void* data, size_t bytes) {
            const char* at = static_cast<const char*>(data);
            while (bytes > 0) {
                const ssize_t written = ::write(file.fd, at, bytes);
                if (written < 0 && errno == EINTR) continue;
                if (written < 0) fail_write(temporary, "write");
                at += written;
                bytes -= static_cast<size_t>(written);
            }
        });
        if (fsync(file.fd) != 0) fail_write(temporary, "sync");
        if (rename(temporary.c_str(), path.c_str()) != 0) fail_write(path, "replace");
    } catch (...) {
        unlink(temporary.c_str());
        throw;
    }
    const FileDescriptor directory(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (directory.fd >= 0) fsync(directory.fd);  // best effort: some file systems refuse to sync folders
}

std::vector<uint8_t> read_file(const std::filesystem::path& path, uint64_t limit_bytes) {
    const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.fd < 0) throw InputError(path.string(), "", fmt::format("cannot open: {}", std::strerror(errno)));
    struct stat status {};
    if (fstat(file.fd, &status) != 0 || !S_ISREG(status.st_mode))
        throw InputError(path.string(), "", "is not a regular file");
    const auto size = static_cast<uint64_t>(status.st_size);
    if (size > limit_bytes)
        throw InputError(path.string(), "",
                         fmt::format("is {} bytes, more than the {} allowed here", size, limit_bytes));
    std::vector<uint8_t> bytes(size);
    size_t filled = 0;
    while (filled < bytes.size()) {
        const ssize_t got = read(file.fd, bytes.data() + filled, bytes.size() - filled);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw InputError(path.string(), "", fmt::format("cannot read: {}", std::strerror(errno)));
        if (got == 0) break;
        filled += static_cast<size_t>(got);
    }
    bytes.resize(filled);
    return bytes;
}

bool folder_is_writable(const std::filesystem::path& folder) {
    return ::access(folder.c_str(), W_OK | X_OK) == 0;
}

uint64_t peak_memory_bytes() {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

void catch_stop_signals() {
    std::signal(SIGINT, on_stop_signal);
    std::signal(SIGTERM, on_stop_signal);
}

bool stop_requested() {
    return g_stop != 0;
}

bool stderr_is_terminal() {
    return isatty(STDERR_FILENO) != 0;
}

std::filesystem::path cache_folder() {
    const char* xdg = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    std::filesystem::path folder;
    if (xdg && *xdg)
        folder = std::filesystem::path(xdg) / "neuvv";
    else if (home && *home)
        folder = std::filesystem::path(home) / ".cache" / "neuvv";
    else
        return {};
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    return error ? std::filesystem::path() : folder;
}

}  // namespace neuvv

#include "base/platform.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <utility>

#include "base/descriptor.h"
#include "base/error.h"

namespace neuvv {

namespace {

// A regular file and its size. A pipe would be opened without waiting for its writer, which blocks all others.
std::pair<int, uint64_t> open_regular_file(const std::filesystem::path& path) {
    const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) {
        const int error = errno;
        throw InputError(path.string(), "", fmt::format("cannot open: {}", std::strerror(error)),
                         error == EACCES ? "check its permissions" : "check the path");
    }
    struct stat status {};
    if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode))
        return {descriptor, static_cast<uint64_t>(status.st_size)};
    close(descriptor);
    throw InputError(path.string(), "", "is not a regular file", "name a file");
}

uint64_t rounded_up(uint64_t bytes) {
    return (bytes + SpooledMemory::kRounding - 1) / SpooledMemory::kRounding * SpooledMemory::kRounding;
}

volatile std::sig_atomic_t g_stop = 0;  // the signal that asked for it
unsigned g_patience_s = kEndless;
std::atomic<bool> g_heeded = false;  // somebody knows of the request
timespec g_stop_requested_at{};      // used by the handler alone

void on_stop_signal(int signal) {
    // Signals this close are one request: `timeout` signals a program, then its group.
    constexpr double kTogether_s = 0.5;
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const double since_s = static_cast<double>(now.tv_sec - g_stop_requested_at.tv_sec) +
                           1e-9 * static_cast<double>(now.tv_nsec - g_stop_requested_at.tv_nsec);
    if (g_stop && since_s > kTogether_s) {  // a second request: stop at once
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    if (!g_stop) {
        g_stop_requested_at = now;
        if (g_patience_s != kEndless) alarm(g_patience_s);
    }
    g_stop = signal;
}

void on_unheeded_stop(int) {
    if (g_heeded) return;
    std::signal(g_stop, SIG_DFL);
    std::raise(g_stop);
}

}  // namespace

uint64_t expect_regular_file(const std::filesystem::path& path) {
    const auto [descriptor, size] = open_regular_file(path);
    close(descriptor);
    return size;
}

std::vector<uint8_t> read_file(const std::filesystem::path& path, uint64_t limit_bytes) {
    const auto [descriptor, size] = open_regular_file(path);
    const Descriptor file(descriptor);
    if (size > limit_bytes)
        throw InputError(path.string(), "",
                         fmt::format("is {} bytes, more than the {} allowed here", size, limit_bytes));
    std::vector<uint8_t> bytes(size);
    size_t filled = 0;
    while (filled < bytes.size()) {
        const ssize_t got = read(file.number, bytes.data() + filled, bytes.size() - filled);
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

bool exchange_files(const std::filesystem::path& a, const std::filesystem::path& b) {
    return renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

std::filesystem::path make_private_folder(const std::filesystem::path& beginning) {
    std::string name = beginning.string() + "XXXXXX";
    if (!mkdtemp(name.data())) throw RuntimeFailure(fmt::format("{}: cannot be made: {}", name, std::strerror(errno)));
    return name;
}

uint64_t peak_memory_bytes() {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

uint64_t allocated_bytes() {
    const struct mallinfo2 heap = mallinfo2();
    return heap.uordblks + heap.hblkhd;  // small blocks, and those with pages of their own
}

void return_freed_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void keep_freed_memory() {
#ifdef __GLIBC__
    static std::once_flag once;
    std::call_once(once, [] {
        mallopt(M_MMAP_THRESHOLD, 1 << 30);
        mallopt(M_TRIM_THRESHOLD, INT_MAX);
        // A thread's heap, of 64 MiB, is unmapped once it is empty, unless this is as large.
        mallopt(M_TOP_PAD, 64 << 20);
    });
#endif
}

SpooledMemory::SpooledMemory(uint64_t memory_budget, std::filesystem::path folder, uint64_t disk_budget)
    : folder_(std::move(folder)), memory_left_(memory_budget), disk_budget_(std::max<uint64_t>(disk_budget, 1)) {}

SpooledMemory::~SpooledMemory() {
    if (mapped_) munmap(mapped_, disk_budget_);
    if (file_ >= 0) close(file_);
}

uint64_t SpooledMemory::bytes_on_disk() const {
    const std::lock_guard lock(mutex_);
    return on_disk_;
}

void SpooledMemory::open_file() {
    std::string name = (folder_ / "neuvv-spool-XXXXXX").string();
    Descriptor file(mkostemp(name.data(), O_CLOEXEC));
    if (file.number < 0) fail_by_errno(name, "create");
    unlink(name.c_str());
    // The mapping is larger than the file, which grows under it.
    void* mapped = mmap(nullptr, disk_budget_, PROT_READ | PROT_WRITE, MAP_SHARED, file.number, 0);
    if (mapped == MAP_FAILED) fail_by_errno(folder_, "map a file");
    mapped_ = static_cast<std::byte*>(mapped);
    file_ = std::exchange(file.number, -1);
}

// Gives the file room for this many bytes: a page without space on the disk would kill the process when it is first
// written to.
void SpooledMemory::reserve(uint64_t bytes) {
    constexpr uint64_t kStep = uint64_t{16} << 20;
    if (bytes <= reserved_) return;
    const uint64_t wanted = std::min(std::max(bytes, reserved_ + kStep), disk_budget_);
    errno = posix_fallocate(file_, static_cast<off_t>(reserved_), static_cast<off_t>(wanted - reserved_));
    if (errno != 0) fail_by_errno(folder_, fmt::format("keep {} MB", (wanted + 999'999) / 1'000'000).c_str());
    reserved_ = wanted;
}

void* SpooledMemory::do_allocate(size_t bytes, size_t alignment) {
    const uint64_t room = rounded_up(bytes);
    const std::lock_guard lock(mutex_);
    if (room <= memory_left_) {
        void* at = std::pmr::new_delete_resource()->allocate(bytes, alignment);
        memory_left_ -= room;
        return at;
    }
    if (room > disk_budget_ - on_disk_) throw std::bad_alloc();
    if (!mapped_) open_file();
    reserve(on_disk_ + room);
    on_disk_ += room;
    return mapped_ + (on_disk_ - room);
}

void SpooledMemory::do_deallocate(void* at, size_t bytes, size_t alignment) {
    const std::lock_guard lock(mutex_);
    const auto address = reinterpret_cast<uintptr_t>(at), first = reinterpret_cast<uintptr_t>(mapped_);
    if (mapped_ && address >= first && address < first + disk_budget_) return;
    std::pmr::new_delete_resource()->deallocate(at, bytes, alignment);
    memory_left_ += rounded_up(bytes);
}

void catch_stop_signals(unsigned patience_s) {
    g_patience_s = patience_s;
    std::signal(SIGALRM, on_unheeded_stop);
    std::signal(SIGINT, on_stop_signal);
    std::signal(SIGTERM, on_stop_signal);
}

void catch_hangup() {
    struct sigaction before {};
    sigaction(SIGHUP, nullptr, &before);
    if (before.sa_handler != SIG_IGN) std::signal(SIGHUP, on_stop_signal);
}

void catch_batch_signals() {
    catch_hangup();
    for (const int signal : {SIGUSR1, SIGXCPU, SIGPIPE}) std::signal(signal, on_stop_signal);
}

bool stop_requested() {
    if (g_stop == 0) return false;
    g_heeded = true;
    return true;
}

void open_standard_streams() {
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
        if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        // The lowest number that is free is this one. Opened for the other direction, it fails as a closed one does.
        if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) return;
    }
}

bool stderr_is_terminal() {
    return isatty(STDERR_FILENO) != 0;
}

void* function_of_loaded_library(const char* library, const char* function) {
    void* handle = dlopen(library, RTLD_NOW | RTLD_NOLOAD);
    if (!handle) return nullptr;
    void* address = dlsym(handle, function);
    dlclose(handle);  // the library stays loaded by its first user
    return address;
}

void* load_library(const char* library) {
    return dlopen(library, RTLD_NOW | RTLD_GLOBAL);
}

void* symbol_of(void* library, const char* name) {
    return dlsym(library, name);
}

void set_environment_default(const char* variable, const char* value) {
    setenv(variable, value, 0);
}

std::filesystem::path program_file() {
    return std::filesystem::read_symlink("/proc/self/exe");
}

namespace {

// The folder "neuvv" in the folder that an environment variable names, else in a folder of the home folder.
std::filesystem::path xdg_folder(const char* variable, const char* in_home) {
    const char* xdg = std::getenv(variable);
    const char* home = std::getenv("HOME");
    std::filesystem::path folder;
    if (xdg && *xdg)
        folder = std::filesystem::path(xdg) / "neuvv";
    else if (home && *home)
        folder = std::filesystem::path(home) / in_home / "neuvv";
    else
        return {};
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    return error ? std::filesystem::path() : folder;
}

}  // namespace

std::filesystem::path cache_folder() {
    return xdg_folder("XDG_CACHE_HOME", ".cache");
}

std::filesystem::path config_folder() {
    return xdg_folder("XDG_CONFIG_HOME", ".config");
}

std::filesystem::path state_folder() {
    return xdg_folder("XDG_STATE_HOME", ".local/state");
}

}  // namespace neuvv

// Every call that differs between operating systems, but for those of the neighbours that README.md names. A port to
// another system is a second file of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <string>
#include <vector>

#include "base/memory_group.h"  // IWYU pragma: export
#include "base/new_file.h"      // IWYU pragma: export

namespace neuvv {

// Throws InputError unless the path leads to a regular file that can be read. To be called before a library opens a
// file by its name: opening a pipe waits for its writer, and reading a device may never end. Returns the file's size.
uint64_t expect_regular_file(const std::filesystem::path& path);

// The whole file. Throws InputError if it is missing, unreadable, no regular file or larger than `limit_bytes`.
std::vector<uint8_t> read_file(const std::filesystem::path& path, uint64_t limit_bytes = UINT64_MAX);

// Whether this process may make files in an existing folder.
bool folder_is_writable(const std::filesystem::path& folder);

// Exchanges two files or folders at once; false where the file system cannot do that.
bool exchange_files(const std::filesystem::path& a, const std::filesystem::path& b);
// A new folder of this user alone, whose name begins as given. Throws RuntimeFailure.
std::filesystem::path make_private_folder(const std::filesystem::path& beginning);

// Peak resident memory of this process, in bytes.
uint64_t peak_memory_bytes();

// Bytes that the C library has given out and that are not freed yet.
uint64_t allocated_bytes();

// Gives freed memory back to the system that the C library keeps for later allocations. It takes some milliseconds: to
// be called between large tasks, so that what one of them took does not add to the peak of the next.
void return_freed_memory();

// From now on, freed memory is kept for later allocations, also that of large arrays, which the C library gives back to
// the system otherwise. Whoever allocates as much again and again, as for each frame of a stream, then need not wait
// for the system to clear pages. Each thread's memory stays as large as it ever was, until return_freed_memory().
void keep_freed_memory();

// The first allocations are plain memory. Those that would take more of it than a budget lie in a file without a name,
// from which the system pages; the file grows with them. Space in the file is not used again; all of it is freed with
// the resource. May be used by several threads.
class SpooledMemory : public std::pmr::memory_resource {
  public:
    static constexpr uint64_t kRounding = 64;  // bytes; each allocation is rounded up to a multiple of these

    // The file is made in `folder` when it is first needed, and holds at most `disk_budget` bytes. An allocation throws
    // RuntimeFailure where the disk has no room.
    SpooledMemory(uint64_t memory_budget, std::filesystem::path folder, uint64_t disk_budget);
    ~SpooledMemory() override;
    uint64_t bytes_on_disk() const;

  private:
    void* do_allocate(size_t bytes, size_t alignment) override;
    void do_deallocate(void* at, size_t bytes, size_t alignment) override;
    bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }
    void open_file();
    void reserve(uint64_t bytes);

    mutable std::mutex mutex_;
    std::filesystem::path folder_;
    uint64_t memory_left_, disk_budget_, on_disk_ = 0, reserved_ = 0;  // reserved_: bytes that the file has
    int file_ = -1;
    std::byte* mapped_ = nullptr;
};

// After this call, SIGINT and SIGTERM set a flag instead of ending the program. A second signal more than half a second
// later ends it. Where nobody has asked for the flag so many seconds after the first, because the program waits for a
// disk or a driver, that ends it, too; but not with kEndless, of programs whose work would be lost.
constexpr unsigned kUsualPatience_s = 10, kEndless = 0;
void catch_stop_signals(unsigned patience_s = kUsualPatience_s);
// The same for SIGHUP, which comes when the terminal is closed; but not where SIGHUP is ignored, as under nohup.
void catch_hangup();
// The same for what ends long work besides: SIGHUP as above, SIGUSR1 and SIGXCPU, which batch systems send before the
// time is up, and SIGPIPE, which comes where nobody reads what is printed any more.
void catch_batch_signals();
bool stop_requested();

bool stderr_is_terminal();

// Opens those of the standard streams that the program was started without, so that no file that it opens later gets
// their numbers, and with them what is printed. Reading and writing such a stream fails. To be called before any file
// is opened.
void open_standard_streams();

// A function of a library that is already in the process, for instance because a debugger loaded it; null where there
// is none. The library is not loaded by this call.
void* function_of_loaded_library(const char* library, const char* function);

// Loads a library for the rest of the process, among whose symbols it also finds its own plug-ins'; null where there is
// none of this name.
void* load_library(const char* library);
// A function or an object of it; null where it has none of this name.
void* symbol_of(void* library, const char* name);

// Sets a variable of the environment, for libraries that read it, unless the user has set it.
void set_environment_default(const char* variable, const char* value);

// The file of the program that is running.
std::filesystem::path program_file();

// The folder for caches of this program (XDG_CACHE_HOME or ~/.cache, plus "neuvv"). It is created; empty where that
// fails.
std::filesystem::path cache_folder();
// The same for settings (XDG_CONFIG_HOME or ~/.config), and for data that must survive a crash (XDG_STATE_HOME or
// ~/.local/state).
std::filesystem::path config_folder();
std::filesystem::path state_folder();

}  // namespace neuvv

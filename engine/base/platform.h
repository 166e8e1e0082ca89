// Every call that differs between operating systems. A port to another system is a second platform.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <memory_resource>
#include <string>
#include <vector>

namespace neuvv {

// Writes a file so that at any moment, power cuts included, the path holds either the old or the new content:
// temporary file beside it, sync, rename, sync of the folder. `write` gets a sink to call with consecutive pieces.
// A link stays, and what it points to is replaced. Throws RuntimeFailure naming the path, which must be replaceable.
using ByteSink = std::function<void(const void* data, size_t bytes)>;
void write_file_atomically(const std::filesystem::path& path, const std::function<void(const ByteSink&)>& write);

// Where a file would be written that has this path: a link's target, there or not, else the path itself.
std::filesystem::path link_target(std::filesystem::path path);

// Whether the path is free or a regular file (links followed): devices, pipes and folders are not replaced.
bool is_replaceable(const std::filesystem::path& file);

// The whole file. Throws InputError if it is missing, unreadable or larger than `limit_bytes`.
std::vector<uint8_t> read_file(const std::filesystem::path& path, uint64_t limit_bytes = UINT64_MAX);

// Whether this process may make files in an existing folder.
bool folder_is_writable(const std::filesystem::path& folder);

// Peak resident memory of this process, in bytes.
uint64_t peak_memory_bytes();

// What this process may still take: the least of the system's free memory and its control group's limit, in bytes.
uint64_t available_memory_bytes();

// Memory for up to `bytes` (each piece rounded up to 64), backed by a file without a name in `folder`: what does not
// fit in RAM waits there. Freed all at once with the resource. Throws RuntimeFailure where the disk has no room.
std::unique_ptr<std::pmr::memory_resource> spooled_memory(const std::filesystem::path& folder, uint64_t bytes);

// After this, SIGINT and SIGTERM set a flag instead of ending the program; a second one, later than half a second, ends
// it.
void catch_stop_signals();
bool stop_requested();

bool stderr_is_terminal();

// A function of a library that is loaded already, by whoever started this program for instance; null where there is
// none. The library is not loaded for that.
void* function_of_loaded_library(const char* library, const char* function);

// Runs a program of PATH to its end; no shell reads the arguments. Throws RuntimeFailure where it cannot be started.
struct ProgramOutput {
    int code = 0;      // 128 and the signal's number where one ended it
    std::string text;  // on stdout and stderr
};
ProgramOutput run_program(std::vector<std::string> arguments);

// Folder for caches of this program (XDG_CACHE_HOME or ~/.cache, plus "neuvv"); created; empty if there is none.
std::filesystem::path cache_folder();
// Likewise for what a user chose (XDG_CONFIG_HOME or ~/.config), and for what shall outlive a crash (XDG_STATE_HOME or
// ~/.local/state).
std::filesystem::path config_folder();
std::filesystem::path state_folder();

}  // namespace neuvv

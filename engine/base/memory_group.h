// The memory that a process may still take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace neuvv {

// How much memory this process may still take, in bytes: the smaller of the system's free memory and of what its
// control groups leave.
uint64_t available_memory_bytes();

// What the control groups of this process leave of the memory that they allow: the least of its own group and of all
// around it, as Slurm, systemd and containers nest them, of versions 1 and 2. Nothing where none has a limit. `root` is
// the folder in which proc and the mounted file systems lie; another one is for tests.
std::optional<uint64_t> memory_left_by_groups(const std::filesystem::path& root = "/");

}  // namespace neuvv

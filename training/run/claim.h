// Claims: of all processes that share a folder, the one that has a run's claim is the only one that trains into its
// .nvv. A claim is a lock on NAME.nvv.lock, which ends with its process, however that ends; the file says who has it
// and how far the run is.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/file_lock.h"

namespace neuvv::training {

class RunClaim {
  public:
    // Nothing where another process has the claim. Throws RuntimeFailure where the folder's file system has no locks.
    static std::optional<RunClaim> take(const std::filesystem::path& nvv);
    RunClaim(RunClaim&& other) noexcept;
    RunClaim& operator=(RunClaim&& other) noexcept;  // swaps
    ~RunClaim();

    // How much of the run's budget is spent, 0..1, for others to read. It may come late or not at all.
    void report(double fraction) const;

  private:
    explicit RunClaim(std::filesystem::path file, FileLock lock);
    std::filesystem::path file_;  // empty after a move
    FileLock lock_;
};

struct ClaimState {
    std::string owner;    // "process 12 of render7", for people
    double fraction = 0;  // of the run's budget
};

// Who trains into this .nvv now, if anybody does. Does not throw.
std::optional<ClaimState> claim_of(const std::filesystem::path& nvv);

// How far the training of a clip's segment is, for people: "process 12 of render7 trains it, 40 % done", "its training
// was interrupted"; empty where it is finished. Does not throw.
std::string unfinished_training(const std::filesystem::path& segment);

}  // namespace neuvv::training

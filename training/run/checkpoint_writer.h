// Writes a run's checkpoints on a thread of its own, one at a time, so that training goes on meanwhile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <future>

#include "training/run/checkpoint.h"

namespace neuvv::training {

class CheckpointWriter {
  public:
    // The files of a checkpoint that were written. Before the first one all is 0.
    struct Written {
        uint64_t step = 0;
        uint32_t tree_leaves = 0, leaves = 0;  // of the run's tree, of the .nvv
        uint64_t bytes = 0;                    // of the .nvv
        double took_s = 0;                     // with what came before begin()
    };

    // Waits for the checkpoint before. `began_s`: when the work for this one began, by seconds_now().
    void begin(const std::filesystem::path& nvv, Checkpoint checkpoint, double began_s);
    // Waits for the checkpoint that is being written, if any, and throws what writing it threw.
    void wait();
    // Does not wait; throws where a checkpoint has failed, because the disk is full for instance.
    void check();
    // The last one that was written, of those that were waited for or checked.
    const Written& last() const { return last_; }

    // Seconds that the next checkpoint may take, of a tree that may have become many times as large. A part of what a
    // small one took does not grow with the tree.
    double next_will_take_s(uint32_t tree_leaves) const;

    // Whether a checkpoint is due after `every_s`, or later, so that they take a twentieth of the time at most. A run
    // that ends sooner than its checkpoint is written would only have to wait for it.
    bool is_due(double every_s, double seconds_left, uint32_t tree_leaves) const;

  private:
    std::future<Written> writing_;
    Written last_;
    double began_at_ = 0;  // when the state of the last checkpoint had been read
};

}  // namespace neuvv::training

#include "training/run/checkpoint_writer.h"

#include <algorithm>
#include <chrono>

#include "base/seconds.h"
#include "base/trace_file.h"

namespace neuvv::training {

namespace {

constexpr double kShareOfTime = 0.05;  // that checkpoints take at most

CheckpointWriter::Written write(const std::filesystem::path& nvv, Checkpoint checkpoint, double began_s) {
    CheckpointWriter::Written written;
    written.step = checkpoint.run.step;
    written.tree_leaves = checkpoint.tree.leaf_count;
    written.leaves = save_checkpoint(nvv, std::move(checkpoint));
    written.bytes = std::filesystem::file_size(nvv);
    written.took_s = seconds_now() - began_s;
    return written;
}

}  // namespace

void CheckpointWriter::begin(const std::filesystem::path& nvv, Checkpoint checkpoint, double began_s) {
    wait();
    writing_ = std::async(std::launch::async, write, nvv, std::move(checkpoint), began_s);
    began_at_ = seconds_now();
}

void CheckpointWriter::wait() {
    if (!writing_.valid()) return;
    const TraceSpan span("wait for the checkpoint");
    last_ = writing_.get();
}

void CheckpointWriter::check() {
    if (writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) wait();
}

double CheckpointWriter::next_will_take_s(uint32_t tree_leaves) const {
    if (last_.tree_leaves == 0) return 0;
    return last_.took_s * std::clamp(static_cast<double>(tree_leaves) / last_.tree_leaves, 1.0, 10.0);
}

bool CheckpointWriter::is_due(double every_s, double seconds_left, uint32_t tree_leaves) const {
    const double will_take_s = next_will_take_s(tree_leaves);
    return seconds_now() - began_at_ > std::max(every_s, will_take_s / kShareOfTime) && seconds_left > will_take_s;
}

}  // namespace neuvv::training

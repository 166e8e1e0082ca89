#include "training/run/trained_tree.h"

#include <algorithm>

#include "base/trace_file.h"
#include "training/rig/pose_probe.h"
#include "training/run/schedule.h"
#include "training/step/array_buffers.h"

namespace neuvv::training {

namespace {

// How many leaves there is room for in the memory that was free when the run began, with its images read: where a
// control group allows little, the process would be killed without a word. A leaf takes its weights several times, with
// those of the checkpoint that is being written, and of a device whose memory is the system's also their moments and
// gradients; and what does not depend on their number, such as its place and its slice (measured: 2.4 kB of leaves with
// 176 bytes of weights).
uint64_t leaves_in_memory(const gpu::Device& device, uint64_t memory_bytes, uint64_t bytes_of_weights) {
    constexpr uint64_t kOnHost = 3, kOnBoth = 6, kOfAny = 1400, kPipelines = uint64_t{100} << 20;
    const uint64_t bytes = bytes_of_weights * (device.summary().kind == "cpu" ? kOnBoth : kOnHost) + kOfAny;
    return (memory_bytes - std::min(memory_bytes, kPipelines)) / bytes;
}

}  // namespace

void make_step(const gpu::Device& device, TrainedTree& trained, size_t cameras, uint32_t tiles, const Team& team) {
    const TraceSpan span("buffers of the step");
    trained.finest = 0;
    for (const voctree::LeafPosition& position : voctree::leaf_positions(trained.tree))
        trained.finest = std::max(trained.finest, position.depth);
    trained.step.reset();  // frees its memory before the next one takes some
    // search_rig() also traces variants of a camera.
    const uint32_t all_cameras = std::max(static_cast<uint32_t>(cameras), kPoseVariants);
    // A member's share of a batch may be larger than its tiles_per_step by a part of an image tile.
    constexpr uint32_t kRaysOfPixel = kSeveralRays * kSeveralRays;
    const uint32_t all_tiles = (tiles + kRaysOfPixel - 1) / kRaysOfPixel * kRaysOfPixel;
    trained.step = std::make_unique<TrainingStep>(device, trained.tree, all_cameras, all_tiles, team);
}

uint32_t trainable_leaves(const gpu::Device& device, const voctree::VOctree& tree, uint64_t memory_bytes) {
    uint64_t limit = std::min(kMaxTrainingLeaves, max_training_slots(device, tree.hh_degree));
    const uint64_t planes = 2 * ((tree.bases + 3) / 4) + hh_count(tree.hh_degree);
    limit = std::min<uint64_t>(limit, array_buffers(device).max_elements(16) / planes);
    limit = std::min(limit, device.max_allocation_bytes() / (16 * planes));
    return static_cast<uint32_t>(std::min(limit, leaves_in_memory(device, memory_bytes, 16 * planes)));
}

}  // namespace neuvv::training

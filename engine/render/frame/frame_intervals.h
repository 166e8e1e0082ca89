// Frame intervals: the intervals of the rays of a frame, on the host.
#pragma once

#include <functional>
#include <span>

#include "render/frame/frame_queue.h"
#include "render/frame/frame_recorder.h"
#include "render/rays/ray_intervals.h"

namespace neuvv::render {

// Takes the intervals of one ray. `ray` is its place in the rows of rays.
using TakeIntervals = std::function<void(glm::uvec2 ray, std::span<const RayInterval> intervals)>;

// Traces the rays of the last frame once more, band by band, as instances that are merged are traced, and calls `take`
// with the intervals of each ray that has any, tile by tile. The plan must be that of the last frame, which must be
// finished and have one view without upscaling (assert). Afterwards the rays are cleared.
void read_frame_intervals(const gpu::Device& device, FrameQueue& queue, FrameRecorder& recorder, const FramePlan& plan,
                          std::span<const std::unique_ptr<Performer>> performers, const TakeIntervals& take);

}  // namespace neuvv::render

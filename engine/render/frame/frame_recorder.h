// Frame recorder: a whole frame, pass by pass. Start reading in frame_recorder.cpp.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "render/frame/frame_plan.h"
#include "render/rays/clear_rays.h"
#include "render/rays/image_list.h"
#include "render/set/set_raster.h"
#include "render/volume/inspect.h"
#include "render/volume/intervals.h"
#include "render/volume/performer_shadows.h"
#include "render/volume/volume_depth.h"

namespace neuvv::render {

// What a frame is recorded from.
struct FrameParts {
    gpu::Commands& commands;
    uint32_t slot;  // of FrameQueue
    const FramePlan& plan;
    const FrameSettings& settings;
    std::span<const std::unique_ptr<Performer>> performers;  // SliceResidency::performers
};

// Owns the images of one capacity, what rays are traced into, and the passes that are bound to these. Passes that not
// all frames need are created by the first frame that does. A frame is recorded after make_passes() for its plan.
class FrameRecorder {
  public:
    // `set`, if not null, is drawn with the performers. All arguments must outlive the recorder.
    FrameRecorder(const gpu::Device& device, const FrameCapacity& capacity, SetRaster* set);
    // Takes over the shadows of another one for the same set, to which its performers are bound.
    void take_over(FrameRecorder& other) { shadows_ = std::move(other.shadows_); }

    // Throws RuntimeFailure where there is no room for images of this layout without upscaling.
    void expect_room(const ViewLayout& layout) const;

    RayTarget& target() { return target_; }
    const RayTarget& target() const { return target_; }
    RayClearer& clearer() { return clearer_; }
    SetRaster* set() const { return set_; }  // null where there is none
    // The images, one after the other, and their copy for the host.
    const gpu::Buffer& image() const { return image_; }
    const gpu::Buffer& readback() const { return readback_; }
    // By the number of the target: kEyeTarget and, where there is a set, kLightTarget.
    std::vector<PerformerTarget> performer_targets() const;

    // Creates what draws images with fewer rays than pixels.
    void make_upscaler();
    // Finds the instances that cast shadows, and returns them.
    std::span<const DrawnInstance> plan_shadows(const FieldLevels& levels, std::span<const Instance> instances);
    // Creates the passes of a frame that do not exist yet. Its slices must have been requested.
    void make_passes(const FramePlan& plan, const FrameSettings& settings, const SliceResidency& slices);
    // Drops what depends on the fields. No frame may be under way.
    void forget_fields() { inspector_.reset(); }

    void record_frame(const FrameParts& frame);
    // To be recorded after the frame, where the host reads its images.
    void record_readback(gpu::Commands& commands, const ViewLayout& layout);

    // The intervals of merged instances, created when first needed.
    Intervals& intervals();
    void begin_intervals(uint32_t slot);
    bool intervals_overflowed(uint32_t slot) const { return intervals_ && intervals_->overflowed(slot); }
    // Makes more room for intervals where it was too little in any slot. No frame may be under way.
    void enlarge_intervals(std::span<const std::unique_ptr<Performer>> performers);
    // Frees the intervals. All performers must be freed, too, before the next frame.
    void drop_intervals() { intervals_.reset(); }

  private:
    void record_playing(const FrameParts& frame);
    void record_inspected(const FrameParts& frame);
    void record_blank(const FrameParts& frame);
    void record_rays(const FrameParts& frame);
    void record_merged(const FrameParts& frame, std::span<const DrawnInstance> group);
    const gpu::Device& device_;
    uint32_t views_;            // the most
    uint64_t interval_budget_;  // FrameCapacity::interval_budget
    SetRaster* set_;
    RayTarget target_;
    gpu::Buffer image_, readback_;
    // What image_ was drawn for, outside the tiles that target_.ranges.image_shown marks; nothing: it is to be drawn
    // anew.
    std::optional<std::pair<ViewLayout, ResolveSettings>> blank_key_;
    RayClearer clearer_;
    std::unique_ptr<Intervals> intervals_;
    ImageLister lister_;
    Resolver resolver_, listed_resolver_;        // of all tiles; of the listed tiles
    std::unique_ptr<Resolver> upscaler_;         // created when first needed
    std::unique_ptr<Inspector> inspector_;       // likewise
    std::unique_ptr<PerformerShadows> shadows_;  // where there is a set
    std::unique_ptr<VolumeDepth> volume_depth_;  // likewise
};

}  // namespace neuvv::render

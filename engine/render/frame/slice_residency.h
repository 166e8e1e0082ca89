// Slice residency: which slices of a renderer's fields are on the device.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/frame/frame_settings.h"
#include "render/volume/field_levels.h"

namespace neuvv::render {

// A target to which performers draw (Performer::add_target), with the most views.
struct PerformerTarget {
    const RayTarget* target = nullptr;
    uint32_t views = 1;
};

// What an image reads, and those after it, by field of FieldLevels::all: the most important slices first.
struct SliceRequests {
    std::vector<std::vector<SliceKey>> now, next;
};

// Owns the fields' paints and performers, whose slices share a budget of bytes that only ever becomes smaller. The far
// levels of all fields have performers, or those of none have. Nothing here waits for the device: functions that free
// or replace slices say so, and nobody may read these then: neither an image that is under way nor a pick.
class SliceResidency {
  public:
    // For FrameCapacity::slice_budget, of which the device may leave less. Device and fields must outlive it.
    SliceResidency(const gpu::Device& device, std::vector<const Field*> fields, uint64_t budget);
    // Takes over what another one of these fields has. Performers draw to this target in place of kEyeTarget. The other
    // one can only be destroyed afterwards.
    void take_over(SliceResidency& other, const PerformerTarget& eyes);

    const FieldLevels& levels() const { return levels_; }
    // Those that were given.
    std::vector<const Field*> fields() const { return {levels_.all.begin(), levels_.all.begin() + levels_.given()}; }
    Paints& paints(uint32_t field) { return *paints_[field]; }
    // The bytes that slices may take now; 1: one slice of each field.
    uint64_t budget() const { return budget_; }
    // By field of levels().all; empty before the first image. Null for far levels that have none.
    std::span<const std::unique_ptr<Performer>> performers() const { return performers_; }
    // That of a field, without its far levels; null before the first image.
    const Performer* performer(uint32_t field = 0) const {
        return field < performers_.size() ? performers_[field].get() : nullptr;
    }

    // Whether change_fields() with the same arguments would change nothing.
    bool has_fields(std::span<const Field* const> fields, uint32_t shares) const;
    // Replaces the fields (FrameRenderer::change_fields). It frees the slices of those that go and, where the shares
    // are of another size, all slices.
    void change_fields(std::vector<const Field*> fields, uint32_t shares);

    // Creates the performers that do not exist yet, so that no later frame waits for one: those of the given fields
    // and, with `far_levels`, of all of their coarser levels. Returns false where these have no memory although each
    // has but one slice: then free_far_levels() must be called, and the given fields alone have performers until
    // fields change.
    bool ensure_performers(std::span<const PerformerTarget> targets, bool far_levels);
    // Frees the slices of far levels.
    void free_far_levels();
    // Makes the level at which an instance is drawn its field, also of the instances whose slices are prefetched.
    void choose_far_levels(std::span<const stage::Camera> cameras, FrameSettings& settings) const;

    // Requests slices before an image is recorded. All performers must exist.
    void request(const SliceRequests& requests);
    // Whether request() replaces slices that images under way read.
    bool replaces(const SliceRequests& requests) const;
    // The built slice of the instance's field, or of a far level of it, whose time is nearest to the instance's, and
    // the performer that has it. Null where there is none within this many frames.
    std::pair<Performer*, uint32_t> nearest_built(const Instance& instance, float most_frames) const;

    // Whether the image of a slot, which must be finished, had slices without room for all entries.
    bool overflowed(uint32_t slot) const;
    // Makes more room for those that had too little in any slot. It replaces their slices.
    void enlarge();
    // The number of live leaves and of live nodes above them, in all slices that the image of a slot used, which must
    // be finished. Instances of a field at the same time share a slice.
    uint64_t live_entries(uint32_t slot) const;

    // Drops all slices, so that the next image builds them again.
    void forget();
    // Frees all performers, with slices, passes and what these store. From now on slices may take half as much memory
    // as before, or that of one slice of each field. Returns whether there were any.
    bool drop();
    // For an error while an image was prepared, so that performers may be incomplete: frees all slices and returns
    // whether there is less to create next time.
    bool drop_after(const gpu::VulkanError& error);

  private:
    std::unique_ptr<Performer> make_performer(uint32_t index, std::span<const PerformerTarget> targets) const;
    const gpu::Device& device_;
    FieldLevels levels_;
    uint32_t shares_;  // into which the budget is divided
    uint64_t budget_;
    std::vector<std::unique_ptr<Paints>> paints_;         // by field of levels_.all
    std::vector<std::unique_ptr<Performer>> performers_;  // likewise; created by the first image
    std::optional<bool> far_levels_fit_;  // whether there was memory for all of levels_.all; nothing: not tried yet
};

}  // namespace neuvv::render

// The segments of a clip that are shown, on the device: one, or two where one fades into the next; and some that were
// shown before, for clips that are shown again and again. For who shows a clip alone and may wait for the disk;
// StageClips is for stages that play.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "render/volume/performer.h"
#include "render/volume/slices/field.h"
#include "voctree/files/clip_index.h"

namespace neuvv::render {

class ShownSegments {
  public:
    // Reads a segment, by its number too, and uploads it (upload_segment).
    using Upload = std::function<Field(const voctree::ClipSegment&, uint32_t)>;
    // Gets the fields to draw from now on, as long as those of the call before still exist.
    using Changed = std::function<void(const std::vector<const Field*>&)>;

    // The clip must outlive it. Segments that are not shown any more stay on the device, those that were shown last, as
    // long as they take no more than `kept_bytes` and the device has memory for others.
    ShownSegments(const voctree::ClipIndex& clip, Upload upload, uint64_t kept_bytes = 0)
        : clip_(clip), upload_(std::move(upload)), kept_bytes_(kept_bytes) {}

    // Reads and uploads those of these segments that are not there. Returns an instance for
    // each share; its field is an index into the fields that `changed` got last. Throws InputError where a segment
    // cannot be read, and RuntimeFailure where the device has no memory; then it and the renderer can only be
    // destroyed.
    std::vector<Instance> show(const std::vector<voctree::SegmentShare>& shares, const Changed& changed);

    // The number of the segment of a field, by its index among those that `changed` got last.
    uint32_t segment_of(uint32_t field) const { return shown_[field]; }
    // Whether a segment is on the device.
    bool holds(uint32_t segment) const { return held_.contains(segment); }

  private:
    struct Held {
        std::unique_ptr<const Field> field;
        uint64_t last_shown = 0;  // the number of the call of show()
    };
    void show_only(std::vector<uint32_t> segments, const Changed& changed);
    void drop_beyond(uint64_t bytes, const std::vector<uint32_t>& wanted, const Changed& changed);
    std::unique_ptr<const Field> upload(uint32_t segment, const std::vector<uint32_t>& wanted, const Changed& changed);
    const voctree::ClipIndex& clip_;
    Upload upload_;
    uint64_t kept_bytes_;
    uint64_t calls_ = 0;
    std::map<uint32_t, Held> held_;  // by segment
    std::vector<uint32_t> shown_;    // the segments of the fields that `changed` got last, ascending
};

}  // namespace neuvv::render

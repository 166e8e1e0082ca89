// The segments of a clip that are shown, on the device: one, or two where one fades into the next. For who shows a clip
// alone and may wait for the disk; StageClips is for stages that play.
#pragma once

#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "render/field.h"
#include "render/performer.h"
#include "voctree/clip_index.h"

namespace neuvv::render {

class ShownSegments {
  public:
    // Gets a tree and the number of its segment.
    using Upload = std::function<Field(const voctree::VOctree&, uint32_t)>;
    // Gets the fields to draw from now on, as long as those of the call before still exist.
    using Changed = std::function<void(const std::vector<const Field*>&)>;

    // The clip must outlive it.
    ShownSegments(const voctree::ClipIndex& clip, Upload upload) : clip_(clip), upload_(std::move(upload)) {}

    // Reads and uploads those of these segments that are not there, for which it drops others. Returns an instance for
    // each share; its field is an index into the fields that `changed` got last. Throws InputError where a segment
    // cannot be read, and RuntimeFailure where the device has no memory; then it and the renderer can only be
    // destroyed.
    std::vector<Instance> show(const std::vector<voctree::SegmentShare>& shares, const Changed& changed);

    // The number of the segment of a field, by its index among those that `changed` got last.
    uint32_t segment_of(uint32_t field) const { return std::next(fields_.begin(), field)->first; }

  private:
    std::vector<const Field*> fields() const;
    const voctree::ClipIndex& clip_;
    Upload upload_;
    std::map<uint32_t, std::unique_ptr<const Field>> fields_;  // by segment
};

}  // namespace neuvv::render

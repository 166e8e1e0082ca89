#include "tools/export/exported_clip.h"

#include "voctree/slice.h"

namespace neuvv::tools {

const ExportedClip::Segment& ExportedClip::segment_of(uint32_t frame) {
    if (segment_ && frame >= segment_->from.first && frame < segment_->from.end()) return *segment_;
    segment_.reset();  // before the next one is read: together they may be too large
    for (const voctree::ClipSegment& segment : scene_.index.segments)
        if (frame >= segment.first && frame < segment.end()) segment_ = std::make_unique<Segment>(scene_, segment);
    return *segment_;
}

voctree::VOctree ExportedClip::still(uint32_t frame) {
    const Segment& segment = segment_of(frame);
    return voctree::tree_of(voctree::slice_of(segment.tree, frame - segment.from.first, segment.paint.steps),
                            segment.tree.box_min, segment.tree.box_size, segment.tree.fps);
}

interchange::FrameVolume ExportedClip::volume(uint32_t frame) {
    const Segment& segment = segment_of(frame);
    return interchange::frame_volume(segment.tree, frame - segment.from.first, segment.paint.steps);
}

}  // namespace neuvv::tools

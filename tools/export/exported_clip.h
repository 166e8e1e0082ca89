// The clip that `neuvv export` writes, a frame at a time: segments are read when a frame of theirs is asked for.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "interchange/frame_volume.h"
#include "tools/published_scene.h"
#include "voctree/clip.h"

namespace neuvv::tools {

// Frames are counted from the clip's beginning at the rate of the export. Where they lie between two recorded frames,
// they are mixed as in slow motion; of a stream, and between segments without an overlap, they are the nearer one.
class ExportedClip {
  public:
    // `fps`: of the export; none: the clip's own.
    ExportedClip(PublishedScene scene, std::optional<double> fps);

    double fps() const { return fps_; }

    // The frames that a part of the recording has, each recorded frame being as long as any other. `range`: FIRST:LAST
    // in recorded frames; empty: all. Throws InputError where it is no part of the clip, or has no frame or too many.
    struct Frames {
        uint32_t first = 0, last = 0;
        uint32_t count() const { return last - first + 1; }
    };
    Frames frames_in(const std::string& range) const;

    // The segment that holds a frame, with its paint. It lasts until a frame of another one is asked for. Throws
    // InputError.
    struct Segment {
        Segment(const PublishedScene& scene, const voctree::ClipSegment& segment)
            : from(segment), tree(voctree::read_segment(segment)), paint(read_segment_layers(scene, segment, tree)) {}
        voctree::ClipSegment from;
        voctree::VOctree tree;
        SegmentLayers paint;
    };
    const Segment& segment_of(uint32_t frame) { return shown(frame).segment; }

    // A frame with its paint, as a tree of one frame and as leaves. Both throw as segment_of() does.
    voctree::VOctree still(uint32_t frame);
    interchange::FrameVolume volume(uint32_t frame);

  private:
    struct Shown {
        const Segment& segment;
        double frame;  // of the segment
    };
    Shown shown(uint32_t frame);
    double recorded_frame(uint32_t frame) const;

    PublishedScene scene_;
    double fps_;
    double step_ = 1;  // recorded frames from one frame to the next
    std::unique_ptr<Segment> segment_;
    uint32_t segment_number_ = 0;
};

}  // namespace neuvv::tools

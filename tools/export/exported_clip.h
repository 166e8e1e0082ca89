// The clip that `neuvv export` writes, a frame at a time: segments are read when a frame of theirs is asked for.
#pragma once

#include <memory>

#include "interchange/frame_volume.h"
#include "tools/published_scene.h"
#include "voctree/clip.h"

namespace neuvv::tools {

class ExportedClip {
  public:
    explicit ExportedClip(PublishedScene scene) : scene_(std::move(scene)) {}

    uint32_t frames() const { return scene_.index.frames(); }
    double fps() const { return double{scene_.index.fps}; }

    // The segment that holds a frame, with its paint. It lasts until a frame of another one is asked for. Throws
    // InputError.
    struct Segment {
        Segment(const PublishedScene& scene, const voctree::ClipSegment& segment)
            : from(segment), tree(voctree::read_segment(segment)), paint(read_segment_layers(scene, segment, tree)) {}
        voctree::ClipSegment from;
        voctree::VOctree tree;
        SegmentLayers paint;
    };
    const Segment& segment_of(uint32_t frame);

    // A frame with its paint, as a tree of one frame and as leaves. Both throw as segment_of() does.
    voctree::VOctree still(uint32_t frame);
    interchange::FrameVolume volume(uint32_t frame);

  private:
    PublishedScene scene_;
    std::unique_ptr<Segment> segment_;
};

}  // namespace neuvv::tools

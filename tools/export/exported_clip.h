// The clip that `neuvv export` writes, a frame at a time: segments are read when a frame of theirs is asked for.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "tools/publish/published_scene.h"
#include "voctree/files/world_frame.h"
#include "voctree/kinds/clip_source.h"

namespace neuvv::tools {

// Frames are counted from the beginning of the clip, or of the stage, at the rate of the export. Where they lie between
// two recorded frames, they are mixed as in slow motion; of a stream, and between segments without an overlap, they are
// the nearer one.
class ExportedClip {
  public:
    // `fps`: of the export; none: the clip's own, or the stage's. `in_stage`: frames are those of the stage, in whose
    // space the performer is where the stage has it, and nothing while it is hidden; the scene must be a performer of a
    // stage (assert).
    ExportedClip(PublishedScene scene, std::optional<double> fps, bool in_stage);

    double fps() const { return fps_; }

    // The frames that a part of the recording has, each recorded frame being as long as any other. `range`: FIRST:LAST
    // in recorded frames; empty: all. Throws InputError where it is no part of the clip, or has no frame or too many.
    struct Frames {
        uint32_t first = 0, last = 0;
        uint32_t count() const { return last - first + 1; }
    };
    Frames frames_in(const std::string& range) const;

    // A frame with its paint, as a slice, and as a tree of one frame that shows what a stream would. In a stage, they
    // have its lengths and are still to be turned about the origin by rotation(). Both throw InputError where the
    // segment or its paint cannot be read, or the performer is stretched, sheared or mirrored.
    slice::Slice slice_of(uint32_t frame);
    voctree::VOctree still(uint32_t frame);
    glm::dquat rotation(uint32_t frame) const { return pose_at(frame).rotation; }
    // The depth of the finest leaves that the frame's segment has at any time. Throws as slice_of().
    uint32_t finest_depth(uint32_t frame);

    // Where frames are in the coordinates of the capture; in a stage, the stage's own coordinates count.
    const voctree::WorldFrame& capture() const { return capture_; }

    bool is_hidden(uint32_t frame) const { return pose_at(frame).hidden; }

  private:
    // One that was read, with its paint.
    struct Segment {
        Segment(const PublishedScene& scene, const voctree::ClipSegment& segment);
        voctree::SegmentContent content;
        SegmentLayers paint;
    };
    struct Shown {
        const Segment& segment;
        double frame;  // of the segment
    };
    Shown shown(uint32_t frame);
    double recorded_frame(uint32_t frame) const;
    // p of the clip's space is at rotation · (scale · p + shift) in the stage's.
    struct Pose {
        double frame = 0;  // recorded
        glm::dquat rotation{1, 0, 0, 0};
        double scale = 1;
        glm::dvec3 shift{0};  // metres
        bool hidden = false;
    };
    Pose pose_at(uint32_t frame) const;

    PublishedScene scene_;
    voctree::WorldFrame capture_;
    double fps_;
    bool in_stage_;
    uint32_t recorded_frames_;  // of the clip, or of the stage at its rate
    double step_ = 1;           // of those, from one frame to the next
    std::unique_ptr<Segment> segment_;
    uint32_t segment_index_ = 0;
};

// Of files without room for it: "; the file's origin is (x, y, z) of the capture". Empty where both are the same.
std::string origin_text(const voctree::WorldFrame& capture);

}  // namespace neuvv::tools

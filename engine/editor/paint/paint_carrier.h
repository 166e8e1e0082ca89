// Carries paint on a clip in segments from the segment that is seen to the others, one segment at a time, so that a
// program may stop in between. Selections come without frames; each segment's edits get frames of its own file.
#pragma once

#include <optional>

#include "editor/paint/paint_surface.h"
#include "voctree/files/clip_index.h"

namespace neuvv::editor {

// The part of frames of a clip that is in a segment's file, as frames of it; none (first > last) where there is none.
edit::EditFrames frames_in(const edit::EditFrames& frames, const voctree::ClipSegment& segment);

class PaintCarrier {
  public:
    using Edits = std::vector<voctree::LeafEdit>;
    // `selected` are edits of the segment `seen`, whose clip this is; their frames do not matter. `frames` are of the
    // whole clip.
    PaintCarrier(const voctree::ClipIndex& index, const edit::EditFrames& frames, uint32_t seen,
                 std::shared_ptr<const PaintClip> clip, Edits selected);

    // The edits of the segment that is seen.
    const Edits& seen_edits() const { return seen_edits_; }
    // Goes on to the next segment that may get edits, and returns its number: first those behind the one that is seen,
    // then those before it, from the nearest to the farthest. Nullopt: there are no more.
    std::optional<uint32_t> next();
    // The edits of that segment, whose clip this is; to be called once after each next().
    Edits edits_in(const std::shared_ptr<const PaintClip>& clip);

  private:
    // A segment and its edits.
    struct Painted {
        std::shared_ptr<const PaintClip> clip;
        Edits edits;
    };
    bool step();
    bool is_reached();
    const voctree::ClipIndex index_;
    const edit::EditFrames frames_;
    const uint32_t seen_;
    const std::shared_ptr<const PaintClip> seen_clip_;
    const Edits selected_;
    Edits seen_edits_;
    int direction_ = 1;
    uint32_t number_ = 0;  // of the segment that next() returned
    Painted last_;         // the segment before it; without a clip where that was not painted
    Edits going_on_;       // edits of last_ that hold until its end, and go on where leaves stay opaque
};

}  // namespace neuvv::editor

// Painting the other segments of a clip, after the one that is seen: one segment after the other by the job queue, so
// that other jobs come in between, and all of them as one step of the history.
#pragma once

#include <deque>
#include <functional>

#include "base/threads/job_queue.h"
#include "editor/editor.h"
#include "editor/paint/paint_carrier.h"
#include "editor/paint/paint_operation.h"
#include "editor/paint/paint_place.h"

namespace neuvv::editor {

using Layer = std::shared_ptr<const voctree::EditLayer>;

// What is painted in which segments. Only jobs call the functions, one at a time.
struct SpreadPaint {
    struct Painted {
        Layer after;                // null: nothing is painted
        PaintCarrier::Edits edits;  // what was added, so that it can be added to another layer; none of a region
    };
    std::function<std::optional<uint32_t>()> next;  // the next segment's number; nullopt: there are no more
    // That segment's part of the layer with what is painted there.
    std::function<Painted(const std::shared_ptr<const PaintClip>& clip, const Layer& before)> paint;
};
// Edits that go on in other segments.
SpreadPaint spread_edits(const std::shared_ptr<PaintCarrier>& carrier);
// All leaves of a region, in each segment but the one that is seen. The operation's frames are of the clip.
SpreadPaint spread_region(const PaintPlace& seen, const PaintOperation& operation, const edit::Region& region);

// Whether edits of this kind are carried: colours and densities of a selection. Shifted colours are those of each leaf,
// and restoring removes edits.
inline bool is_carried(PaintOperation::Kind kind) {
    return kind == PaintOperation::Kind::kColour || kind == PaintOperation::Kind::kErase;
}

// What a PaintSession gets for the segment that is seen: the layer before, and its frames, which are none (first >
// last) where the operation's frames of the clip are elsewhere. Of what is carried, it selects leaves on a layer
// without others, at the frame that is seen, and carry_on() makes edits of them.
struct SeenPaint {
    Layer before;
    edit::EditFrames frames;
    bool is_carried = false;
    bool has_frames() const { return frames.first <= frames.last; }
};
SeenPaint seen_paint(const PaintPlace& place, const PaintClip& clip, const Layer& before,
                     const edit::EditFrames& of_clip, bool is_carried);

// A selection in the segment that is seen (SeenPaint), at these frames of the clip: that segment's layer, null where
// nothing is painted in it, and what carries the selection on.
struct CarriedPaint {
    Layer layer;
    std::shared_ptr<PaintCarrier> carrier;
};
CarriedPaint carry_on(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                      const Layer& selected, const edit::EditFrames& of_clip);

// All leaves of a region, at the operation's frames of the clip. Edits that follow leaves are those of the segment that
// is seen, carried; else each segment has leaves of its own in the region. `layer` is null where nothing is painted in
// the segment that is seen; `spread` is what is painted in others, nothing for a clip that is one file.
struct PaintedRegion {
    Layer layer;
    std::optional<SpreadPaint> spread;
};
PaintedRegion paint_region(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                           PaintOperation operation, const edit::Region& region);

// The spreads of a program, one after the other, so that each finds what the one before it has painted. A spread ends
// with a notice, and nothing in other segments is painted, where the painted layer has gone or the stroke was undone,
// where nodes have been added or removed, where the performer plays another clip, or where another document is open.
// Where a segment cannot be read, what was painted by then is kept. A segment whose layer was painted in between gets
// the edits over that; of a region, which is no list of edits, it stays as it is.
class PaintSpreads {
  public:
    // Both must outlive it; jobs must be stopped before it is destroyed.
    PaintSpreads(Editor& editor, JobQueue& jobs) : editor_(editor), jobs_(jobs) {}

    // The layer at `layer` of a performer's node is painted. `before` and `after` are the file of the segment that is
    // seen as it was and is now; null where nothing is painted in it. Then the spread adds the layer to the performer's
    // list, where it is new, and says so where it has painted nothing.
    void start(const PaintPlace& place, uint32_t node, const std::filesystem::path& layer, const Layer& before,
               const Layer& after, SpreadPaint paint);
    // To be called in each frame. Without `may_edit`, as while somebody paints, what is done waits.
    void update(bool may_edit);
    bool is_idle() const { return spreads_.empty(); }

  private:
    class Spread;
    Editor& editor_;
    JobQueue& jobs_;
    std::deque<std::shared_ptr<Spread>> spreads_;  // the first one is under way
};

}  // namespace neuvv::editor

// Painting the other segments of a clip, after the one that is seen: one segment after the other by the job queue, so
// that other jobs come in between, and all of them as one step of the history.
#pragma once

#include <functional>

#include "base/job_queue.h"
#include "editor/editor.h"
#include "editor/paint_carrier.h"
#include "editor/paint_operation.h"
#include "editor/paint_place.h"

namespace neuvv::editor {

using Layer = std::shared_ptr<const voctree::EditLayer>;

// What is painted in which segments. Only jobs call the functions, one at a time.
struct SpreadPaint {
    std::function<std::optional<uint32_t>()> next;  // the next segment's number; nullopt: there are no more
    // That segment's part of the layer with what is painted there, or null where nothing is.
    std::function<Layer(const std::shared_ptr<const PaintClip>& clip, const Layer& before)> paint;
};
// Edits that go on in other segments.
SpreadPaint spread_edits(std::shared_ptr<PaintCarrier> carrier);
// All leaves of a region, in each segment but the one that is seen. The operation's frames are of the clip.
SpreadPaint spread_region(const PaintPlace& seen, const PaintOperation& operation, const edit::Region& region);

// A selection in the segment that is seen (edits of PaintSession::layer on a layer without others, whatever their
// frames), at these frames of the clip: that segment's layer, null where nothing is painted in it, and what carries the
// selection on.
struct CarriedPaint {
    Layer layer;
    std::shared_ptr<PaintCarrier> carrier;
};
CarriedPaint carry_on(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                      const Layer& selected, const edit::EditFrames& frames);
// Whether edits of this kind are carried: colours and densities of a selection. Shifted colours are those of each leaf,
// and restoring removes edits.
inline bool is_carried(PaintOperation::Kind kind) {
    return kind == PaintOperation::Kind::kColour || kind == PaintOperation::Kind::kErase;
}

// All leaves of a region, at the operation's frames of the clip. Edits that follow leaves are those of the segment that
// is seen, carried; else each segment has leaves of its own in the region. `layer` is null where nothing is painted in
// the segment that is seen; `spread` is what is painted in others, nothing for a clip that is one file.
struct PaintedRegion {
    Layer layer;
    std::optional<SpreadPaint> spread;
};
PaintedRegion paint_region(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                           PaintOperation operation, const edit::Region& region);

// Begins to paint the layer at `layer` of a performer's node. Segments that were painted in between stay as they are,
// and a notice says so; nothing is painted where the layer has gone, or another document is open. What cannot be read
// ends it with a notice, and what was painted by then is kept. `editor` and `jobs` must outlive it.
void start_spread(Editor& editor, JobQueue& jobs, const PaintPlace& place, uint32_t node,
                  const std::filesystem::path& layer, SpreadPaint paint);

}  // namespace neuvv::editor

// How `neuvv paint` paints on clips in segments: what is painted on one segment goes on in the others.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "tools/paint/painted_scene.h"

namespace neuvv::tools {

// What layers of paint hold.
struct LayerTotals {
    size_t segments = 0, edits = 0, leaves = 0, colours = 0, densities = 0, erased = 0;
    uint64_t field_leaves = 0;
    void add(const voctree::EditLayer& layer);
};

// A function that paints on a segment at frames of that segment. It returns the layer `before` with what it painted, or
// null where there was no leaf to paint.
using Layer = std::shared_ptr<const voctree::EditLayer>;
using Painting = std::function<Layer(const PaintedSegment&, const Layer& before, const edit::EditFrames&)>;
// How a painting goes on through the segments of a clip.
enum class Spread {
    kEach,     // each segment is painted by itself
    kCarried,  // the segment that is seen is painted; others get the same edits, carried to their leaves
};

// Paints on the segments of a segmented clip, at frames of the clip, and saves each. Returns false where there was no
// leaf to paint. Throws RuntimeFailure where it is stopped: what was painted until then is kept.
bool paint_segments(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
                    Spread spread, const Painting& painting, LayerTotals& totals);
// The numbers of the segments of which the layer has a file; of a clip that is one file, its number.
std::vector<uint32_t> painted_segments(const PaintedScene& scene, const PaintOptions& options);

}  // namespace neuvv::tools

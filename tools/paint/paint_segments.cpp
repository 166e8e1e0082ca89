#include "tools/paint/paint_segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_set>

#include "base/error.h"
#include "editor/paint/paint_carrier.h"
#include "tools/commands.h"
#include "tools/report.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::tools {

namespace {

using Edits = std::vector<voctree::LeafEdit>;

// Adds edits that have frames to a segment's layer, and saves it.
void add_and_save(PaintedSegment& segment, const Edits& edits, LayerTotals& totals) {
    auto painted = std::make_shared<voctree::EditLayer>(*segment.layer);
    voctree::add_edits(*painted, edits);
    segment.layer = std::move(painted);
    segment.save();
    totals.add(*segment.layer);
}

// Paints the segments of a clip.
class SegmentPainter {
  public:
    SegmentPainter(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
                   const Painting& painting, LayerTotals& totals)
        : scene_(scene),
          options_(options),
          frames_(frames),
          painting_(painting),
          totals_(totals),
          progress_("paint", scene.index.segments.size()) {
        catch_stop_signals();
    }
    bool paint_each();
    bool paint_carried();

  private:
    uint32_t count() const { return static_cast<uint32_t>(scene_.index.segments.size()); }
    void begin_segment();
    const PaintedScene& scene_;
    const PaintOptions& options_;
    const edit::EditFrames& frames_;
    const Painting& painting_;
    LayerTotals& totals_;
    Progress progress_;
    uint32_t begun_ = 0;
};

void SegmentPainter::begin_segment() {
    if (stop_requested())
        throw RuntimeFailure(
            scene_.staged && !scene_.staged->change.empty()
                ? fmt::format("stopped before the end; `neuvv stage paint {} {} --add {}` shows what is painted",
                              options_.scene, scene_.staged->performer().node, options_.layer)
                : "stopped before the end; segments that are painted stay painted");
    progress_.update(begun_++);
}

bool SegmentPainter::paint_each() {
    bool painted = false;
    for (uint32_t number = 0; number < count(); ++number) {
        begin_segment();
        const edit::EditFrames frames = editor::frames_in(frames_, scene_.index.segments[number]);
        if (frames.first > frames.last) continue;
        PaintedSegment segment(scene_, options_, number);
        const Layer layer = painting_(segment, segment.layer, frames);
        if (!layer) continue;
        segment.layer = layer;
        segment.save();
        totals_.add(*layer);
        painted = true;
    }
    progress_.update(count());
    return painted;
}

bool SegmentPainter::paint_carried() {
    const uint32_t number = voctree::segment_frame(scene_.index, double{scene_.at}).segment;
    begin_segment();
    PaintedSegment segment(scene_, options_, number);
    const auto none = std::make_shared<const voctree::EditLayer>(voctree::EditLayer{segment.layer->field, {}});
    const Layer selected = painting_(segment, none, {segment.at, segment.at});
    if (!selected) return false;
    editor::PaintCarrier carrier(scene_.index, frames_, number, segment.clip, selected->edits);
    if (!carrier.seen_edits().empty()) add_and_save(segment, carrier.seen_edits(), totals_);
    while (const std::optional<uint32_t> next = carrier.next()) {
        begin_segment();
        PaintedSegment other(scene_, options_, *next);
        const Edits edits = carrier.edits_in(other.clip);
        if (!edits.empty()) add_and_save(other, edits, totals_);
    }
    progress_.update(count());
    return totals_.segments > 0;
}

}  // namespace

bool paint_segments(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
                    Spread spread, const Painting& painting, LayerTotals& totals) {
    SegmentPainter painter(scene, options, frames, painting, totals);
    return spread == Spread::kEach ? painter.paint_each() : painter.paint_carried();
}

std::vector<uint32_t> painted_segments(const PaintedScene& scene, const PaintOptions& options) {
    std::vector<uint32_t> numbers;
    for (uint32_t i = 0; i < scene.index.segments.size(); ++i)
        if (!scene.is_segmented() ||
            std::filesystem::exists(voctree::paint_file(options.layer, scene.index.segments[i])))
            numbers.push_back(i);
    return numbers;
}

void LayerTotals::add(const voctree::EditLayer& layer) {
    std::unordered_set<uint32_t> painted;
    for (const voctree::LeafEdit& edit : layer.edits) {
        painted.insert(edit.leaf);
        colours += edit.alpha > 0;
        densities += edit.sigma > 0;
        erased += edit.sigma == 0;
    }
    ++segments;
    edits += layer.edits.size();
    leaves += painted.size();
    field_leaves += layer.field.leaf_count;
}

}  // namespace neuvv::tools

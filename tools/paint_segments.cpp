// neuvv paint on clips in segments: what is painted on one segment goes on in the others.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_set>

#include "base/error.h"
#include "edit/carry.h"
#include "tools/commands.h"
#include "tools/paint.h"
#include "tools/report.h"
#include "voctree/nvpaint.h"

namespace neuvv::tools {

namespace {

using Edits = std::vector<voctree::LeafEdit>;

bool has_any(const edit::EditFrames& frames) {
    return frames.first <= frames.last;
}

// Adds edits that have frames to a segment's layer, and saves it.
void add_and_save(PaintedSegment& segment, const Edits& edits, LayerTotals& totals) {
    auto painted = std::make_shared<voctree::EditLayer>(*segment.layer);
    voctree::add_edits(*painted, edits);
    segment.layer = std::move(painted);
    segment.save();
    totals.add(*segment.layer);
}

// Those that hold at a frame.
Edits holding_at(const Edits& edits, float frame) {
    Edits holding;
    for (const voctree::LeafEdit& edit : edits)
        if (edit.first <= frame && frame <= edit.last) holding.push_back(edit);
    return holding;
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
    // A segment with edits, of which it was said until now at which frames they hold.
    struct Neighbour {
        std::shared_ptr<const editor::PaintClip> clip;
        Edits edits;
    };
    uint32_t count() const { return static_cast<uint32_t>(scene_.index.segments.size()); }
    void begin_segment();
    void carry(int direction, uint32_t from, Neighbour last);
    std::optional<Neighbour> carry_to(uint32_t number, int direction, const Neighbour& last);
    const PaintedScene& scene_;
    const PaintOptions& options_;
    const edit::EditFrames& frames_;
    const Painting& painting_;
    LayerTotals& totals_;
    Progress progress_;
    uint32_t begun_ = 0;
    // Of paint_carried: the segment that is seen, and its edits without frames.
    std::shared_ptr<const editor::PaintClip> seen_;
    Edits selected_;
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
    for (uint32_t number = 0; number < count(); number++) {
        begin_segment();
        const edit::EditFrames frames = frames_in(frames_, scene_.index.segments[number]);
        if (!has_any(frames)) continue;
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
    seen_ = segment.clip;
    selected_ = selected->edits;
    const Edits edits = edit::at_frames(seen_->canvas, selected_, frames_in(frames_, scene_.index.segments[number]));
    if (!edits.empty()) add_and_save(segment, edits, totals_);
    for (const int direction : {1, -1}) carry(direction, number, {seen_, edits});
    progress_.update(count());
    return totals_.segments > 0;
}

void SegmentPainter::carry(int direction, uint32_t from, Neighbour last) {
    for (uint32_t number = from + static_cast<uint32_t>(direction); number < count();
         number += static_cast<uint32_t>(direction)) {
        begin_segment();
        std::optional<Neighbour> next = carry_to(number, direction, last);
        last = next ? std::move(*next) : Neighbour{};
    }
}

// Nothing where the segment is not painted. Where edits hold as long as leaves stay opaque, those of the segment before
// that hold until its end go on in this one.
std::optional<SegmentPainter::Neighbour> SegmentPainter::carry_to(uint32_t number, int direction,
                                                                  const Neighbour& last) {
    const voctree::ClipSegment& segment = scene_.index.segments[number];
    const edit::EditFrames frames = frames_in(frames_, segment);
    Edits going_on;
    if (frames_.follow == edit::Follow::kRun && !has_any(frames) && last.clip) {
        const float end = direction > 0 ? static_cast<float>(last.clip->tree.frames - 1) : 0;
        going_on = edit::in_runs(last.clip->canvas, holding_at(last.edits, end), end);
    }
    if (!has_any(frames) && going_on.empty() && frames_.follow != edit::Follow::kAll) return std::nullopt;

    PaintedSegment painted(scene_, options_, number);
    Edits edits = edit::carried(seen_->canvas, selected_, painted.clip->canvas);
    if (!going_on.empty()) {
        std::unordered_set<uint32_t> there;
        for (const voctree::LeafEdit& edit : edit::carried(last.clip->canvas, going_on, painted.clip->canvas))
            there.insert(edit.leaf);
        std::erase_if(edits, [&](const voctree::LeafEdit& edit) { return !there.contains(edit.leaf); });
        edits = edit::in_runs(painted.clip->canvas, edits,
                              direction > 0 ? 0 : static_cast<float>(segment.frames_of_file() - 1));
    } else {
        edits = edit::at_frames(painted.clip->canvas, edits, frames);
    }
    if (edits.empty()) return std::nullopt;
    add_and_save(painted, edits, totals_);
    return Neighbour{painted.clip, std::move(edits)};
}

}  // namespace

edit::EditFrames frames_in(const edit::EditFrames& frames, const voctree::ClipSegment& segment) {
    edit::EditFrames part = frames;
    const auto begin = static_cast<float>(segment.first);
    part.first = std::max(frames.first - begin, 0.0f);
    part.last = std::min(frames.last - begin, static_cast<float>(segment.frames_of_file() - 1));
    return part;
}

bool paint_segments(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
                    Spread spread, const Painting& painting, LayerTotals& totals) {
    SegmentPainter painter(scene, options, frames, painting, totals);
    return spread == Spread::kEach ? painter.paint_each() : painter.paint_carried();
}

std::vector<uint32_t> painted_segments(const PaintedScene& scene, const PaintOptions& options) {
    std::vector<uint32_t> numbers;
    for (uint32_t i = 0; i < scene.index.segments.size(); i++)
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
    segments++;
    edits += layer.edits.size();
    leaves += painted.size();
    field_leaves += layer.field.leaf_count;
}

}  // namespace neuvv::tools

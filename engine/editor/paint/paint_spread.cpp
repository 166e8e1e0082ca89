#include "editor/paint/paint_spread.h"

#include <fmt/format.h>

#include <algorithm>

#include "edit/paint_layers.h"
#include "edit/read.h"
#include "voctree/files/clip.h"

namespace neuvv::editor {

// A spread that waits or is under way. Its functions are the editor's thread's; only work() is a job's.
class PaintSpreads::Spread : public std::enable_shared_from_this<Spread> {
  public:
    Spread(PaintPlace place, uint32_t node, std::filesystem::path layer, Layer before, Layer after, SpreadPaint paint,
           const Editor& editor)
        : place_(std::move(place)),
          node_(node),
          layer_(std::move(layer)),
          before_(std::move(before)),
          after_(std::move(after)),
          paint_(std::move(paint)),
          clip_(edit::clip_of(editor.file(), node)),
          document_{editor.open_count(), editor.node_count()} {}

    bool is_done() const { return done_; }
    // Starts the next job, unless one runs or all are done.
    void go_on(Editor& editor, JobQueue& jobs) {
        if (running_ || done_) return;
        if (!why_unwanted(editor).empty()) {
            done_ = true;
            return;
        }
        running_ = true;
        jobs.start("Painting the other segments",
                   [self = shared_from_this(), &editor,
                    edited = voctree::files_of_layer(editor.document().paint, layer_)]() -> JobQueue::Then {
                       bool goes_on = false;
                       std::string problem;
                       try {
                           goes_on = self->work(edited);
                       } catch (const std::exception& error) {
                           problem = error.what();
                       }
                       return [self, &editor, goes_on, problem] {
                           if (!problem.empty()) editor.notify(problem, true);
                           self->running_ = false;
                           self->done_ = !goes_on;
                       };
                   });
    }
    void finish(Editor& editor) {
        if (const std::string why = why_unwanted(editor); !why.empty())
            return editor.notify(fmt::format("{}: other segments stay as they were", why), true);
        if (painted_.empty()) {
            if (!after_) editor.notify("nothing is there: nothing was painted", true);
            return;
        }
        voctree::PaintLayers files;
        for (const auto& [file, one] : painted_)
            if (Layer layer = newest(editor, file, one)) files[file] = std::move(layer);
        if (const size_t kept = painted_.size() - files.size(); kept > 0)
            editor.notify(fmt::format("{} segments were painted meanwhile: they stay as they are", kept), true);
        if (files.empty()) return;
        const std::string what =
            fmt::format("painted in {} more segment{}", files.size(), files.size() == 1 ? "" : "s");
        if (editor.edit([&](edit::Document& document) {
                return edit::set_paint(document, node_, layer_, "paint", files, what);
            }))
            editor.notify(what);
    }

  private:
    struct OfSegment {
        Layer before;
        SpreadPaint::Painted painted;
    };

    // Paints the next segment. False: there was none.
    bool work(const voctree::PaintLayers& edited) {
        const std::optional<uint32_t> segment_index = paint_.next();
        if (!segment_index) return false;
        const voctree::ClipSegment& segment = place_.index->segments[*segment_index];
        const auto clip = std::make_shared<const PaintClip>(voctree::read_segment(segment));
        const std::filesystem::path file = voctree::paint_file(layer_, segment);
        const auto known = edited.find(file);
        const Layer before =
            known != edited.end()
                ? known->second
                : std::make_shared<const voctree::EditLayer>(voctree::read_segment_paint(layer_, segment, clip->field));
        SpreadPaint::Painted painted = paint_.paint(clip, before);
        if (painted.after) painted_[file] = {before, std::move(painted)};
        return true;
    }
    // Empty: it is wanted.
    std::string why_unwanted(const Editor& editor) const {
        if (document_ != std::pair(editor.open_count(), editor.node_count())) return "the stage is another now";
        const auto layers = edit::paint_layers_of(editor.file(), node_);
        const bool is_listed = layers && std::any_of(layers->begin(), layers->end(),
                                                     [this](const auto& one) { return one.path == layer_; });
        if (!layers || (after_ && !is_listed)) return "the layer has gone";
        if (edit::clip_of(editor.file(), node_) != clip_) return "another clip plays now";
        const auto seen = editor.document().paint.find(place_.layer_file(layer_));
        if (after_ && seen != editor.document().paint.end() && seen->second == before_) return "the stroke was undone";
        return "";
    }
    // What the file becomes; null: it was painted meanwhile, and stays. Opens it in the editor, for undo.
    Layer newest(Editor& editor, const std::filesystem::path& file, const OfSegment& one) const {
        const auto known = editor.document().paint.find(file);
        if (known == editor.document().paint.end() || known->second == one.before) {
            editor.open_layer(file, one.before);
            return one.painted.after;
        }
        if (one.painted.edits.empty()) return nullptr;
        auto after = std::make_shared<voctree::EditLayer>(*known->second);
        voctree::add_edits(*after, one.painted.edits);
        return after;
    }

    const PaintPlace place_;
    const uint32_t node_;
    const std::filesystem::path layer_;
    const Layer before_, after_;  // of the segment that is seen
    const SpreadPaint paint_;
    const std::filesystem::path clip_;            // of the performer
    const std::pair<uint64_t, size_t> document_;  // where they change, node numbers mean other nodes
    std::map<std::filesystem::path, OfSegment> painted_;
    bool running_ = false, done_ = false;
};

void PaintSpreads::start(const PaintPlace& place, uint32_t node, const std::filesystem::path& layer,
                         const Layer& before, const Layer& after, SpreadPaint paint) {
    spreads_.push_back(std::make_shared<Spread>(place, node, layer, before, after, std::move(paint), editor_));
    update(false);
}

void PaintSpreads::update(bool may_edit) {
    if (spreads_.empty()) return;
    const std::shared_ptr<Spread> first = spreads_.front();
    first->go_on(editor_, jobs_);
    if (!first->is_done() || !may_edit || editor_.dragging()) return;
    spreads_.pop_front();
    first->finish(editor_);
    if (!spreads_.empty()) spreads_.front()->go_on(editor_, jobs_);
}

SeenPaint seen_paint(const PaintPlace& place, const PaintClip& clip, const Layer& before,
                     const edit::EditFrames& of_clip, bool is_carried) {
    if (!place.is_segmented()) return {before, of_clip};
    if (!is_carried) return {before, frames_in(of_clip, place.segment())};
    return {std::make_shared<const voctree::EditLayer>(voctree::EditLayer{clip.field, {}}),
            {place.frame, place.frame},
            true};
}

CarriedPaint carry_on(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                      const Layer& selected, const edit::EditFrames& of_clip) {
    if (!selected) return {};
    auto carrier = std::make_shared<PaintCarrier>(*place.index, of_clip, place.segment_index, clip, selected->edits);
    if (carrier->seen_edits().empty()) return {nullptr, carrier};
    auto after = std::make_shared<voctree::EditLayer>(*before);
    voctree::add_edits(*after, carrier->seen_edits());
    return {after, carrier};
}

SpreadPaint spread_edits(const std::shared_ptr<PaintCarrier>& carrier) {
    return {[carrier] { return carrier->next(); },
            [carrier](const std::shared_ptr<const PaintClip>& clip, const Layer& before) -> SpreadPaint::Painted {
                const PaintCarrier::Edits edits = carrier->edits_in(clip);
                if (edits.empty()) return {};
                auto after = std::make_shared<voctree::EditLayer>(*before);
                voctree::add_edits(*after, edits);
                return {after, edits};
            }};
}

SpreadPaint spread_region(const PaintPlace& seen, const PaintOperation& operation, const edit::Region& region) {
    const auto segment_index = std::make_shared<std::optional<uint32_t>>();
    const auto frames = [seen, operation](uint32_t segment) {
        return frames_in(operation.frames, seen.index->segments[segment]);
    };
    return {[=]() -> std::optional<uint32_t> {
                for (uint32_t next = *segment_index ? **segment_index + 1 : 0; next < seen.index->segments.size();
                     ++next) {
                    *segment_index = next;
                    if (next != seen.segment_index && frames(next).first <= frames(next).last) return next;
                }
                return std::nullopt;
            },
            [=](const std::shared_ptr<const PaintClip>& clip, const Layer& before) -> SpreadPaint::Painted {
                PaintOperation there = operation;
                there.frames = frames(**segment_index);
                return {apply_operation(clip->canvas, *before, leaves_for(clip->canvas, *before, region, there), there),
                        {}};
            }};
}

PaintedRegion paint_region(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                           PaintOperation operation, const edit::Region& region) {
    const auto painted = [&](const Layer& on) {
        return apply_operation(clip->canvas, *on, leaves_for(clip->canvas, *on, region, operation), operation);
    };
    if (!place.is_segmented()) return {painted(before), std::nullopt};
    const PaintOperation of_clip = operation;
    const bool follows = operation.frames.follow != edit::Follow::kNot;
    const SeenPaint seen = seen_paint(place, *clip, before, of_clip.frames, follows && is_carried(operation.kind));
    operation.frames = seen.frames;
    const Layer selected = seen.has_frames() ? painted(seen.before) : nullptr;
    if (!seen.is_carried) return {selected, spread_region(place, of_clip, region)};
    const CarriedPaint carried = carry_on(place, clip, before, selected, of_clip.frames);
    if (!carried.carrier) return {};
    return {carried.layer, spread_edits(carried.carrier)};
}

}  // namespace neuvv::editor

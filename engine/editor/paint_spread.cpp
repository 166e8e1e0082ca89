#include "editor/paint_spread.h"

#include <fmt/format.h>

#include <algorithm>

#include "edit/paint_layers.h"
#include "voctree/clip.h"

namespace neuvv::editor {

namespace {

// A spread that is under way. Its functions but work() are the editor's thread's.
class Spread : public std::enable_shared_from_this<Spread> {
  public:
    Spread(Editor& editor, JobQueue& jobs, PaintPlace place, uint32_t node, std::filesystem::path layer,
           SpreadPaint paint)
        : editor_(editor),
          jobs_(jobs),
          place_(std::move(place)),
          node_(node),
          layer_(std::move(layer)),
          paint_(std::move(paint)),
          document_{editor.open_count(), editor.node_count()} {}

    void start_next() {
        jobs_.start("Painting the other segments",
                    [self = shared_from_this(),
                     edited = voctree::files_of_layer(editor_.document().paint, layer_)]() -> JobQueue::Then {
                        bool goes_on = false;
                        std::string problem;
                        try {
                            goes_on = self->work(edited);
                        } catch (const std::exception& error) {
                            problem = error.what();
                        }
                        return [self, goes_on, problem] {
                            if (!problem.empty()) self->editor_.notify(problem, true);
                            if (goes_on && self->is_wanted())
                                self->start_next();
                            else
                                self->finish();
                        };
                    });
    }

  private:
    struct Painted {
        Layer before, after;
    };

    // Paints the next segment. False: there was none.
    bool work(const voctree::PaintLayers& edited) {
        const std::optional<uint32_t> number = paint_.next();
        if (!number) return false;
        const voctree::ClipSegment& segment = place_.index->segments[*number];
        const auto clip = std::make_shared<const PaintClip>(voctree::read_segment(segment));
        const std::filesystem::path file = voctree::paint_file(layer_, segment);
        const auto known = edited.find(file);
        const Layer before =
            known != edited.end()
                ? known->second
                : std::make_shared<const voctree::EditLayer>(voctree::read_segment_paint(layer_, segment, clip->field));
        if (Layer after = paint_.paint(clip, before)) painted_[file] = {before, std::move(after)};
        return true;
    }
    bool is_wanted() const {
        if (document_ != std::pair(editor_.open_count(), editor_.node_count())) return false;
        const auto layers = edit::paint_layers_of(editor_.file(), node_);
        return layers && std::any_of(layers->begin(), layers->end(),
                                     [this](const edit::ListedLayer& one) { return one.path == layer_; });
    }
    // Not in the middle of a stroke, which another edit would end.
    void finish() {
        if (!is_wanted() || painted_.empty()) return;
        if (editor_.dragging()) return jobs_.post([self = shared_from_this()] { self->finish(); });
        voctree::PaintLayers files;
        for (const auto& [file, painted] : painted_) {
            const auto known = editor_.document().paint.find(file);
            if (known != editor_.document().paint.end() && known->second != painted.before) continue;
            editor_.open_layer(file, painted.before);
            files[file] = painted.after;
        }
        if (const size_t kept = painted_.size() - files.size(); kept > 0)
            editor_.notify(fmt::format("{} segments were painted meanwhile: they stay as they are", kept), true);
        if (files.empty()) return;
        const std::string what =
            fmt::format("painted in {} more segment{}", files.size(), files.size() == 1 ? "" : "s");
        if (editor_.edit([&](edit::Document& document) {
                return edit::set_paint(document, node_, layer_, "paint", files, what);
            }))
            editor_.notify(what);
    }

    Editor& editor_;
    JobQueue& jobs_;
    const PaintPlace place_;
    const uint32_t node_;
    const std::filesystem::path layer_;
    const SpreadPaint paint_;
    const std::pair<uint64_t, size_t> document_;  // where they change, node numbers mean other nodes
    std::map<std::filesystem::path, Painted> painted_;
};

}  // namespace

CarriedPaint carry_on(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                      const Layer& selected, const edit::EditFrames& frames) {
    if (!selected) return {};
    auto carrier = std::make_shared<PaintCarrier>(*place.index, frames, place.number, clip, selected->edits);
    if (carrier->seen_edits().empty()) return {nullptr, carrier};
    auto after = std::make_shared<voctree::EditLayer>(*before);
    voctree::add_edits(*after, carrier->seen_edits());
    return {after, carrier};
}

SpreadPaint spread_edits(std::shared_ptr<PaintCarrier> carrier) {
    return {[carrier] { return carrier->next(); },
            [carrier](const std::shared_ptr<const PaintClip>& clip, const Layer& before) -> Layer {
                const PaintCarrier::Edits edits = carrier->edits_in(clip);
                if (edits.empty()) return nullptr;
                auto after = std::make_shared<voctree::EditLayer>(*before);
                voctree::add_edits(*after, edits);
                return after;
            }};
}

SpreadPaint spread_region(const PaintPlace& seen, const PaintOperation& operation, const edit::Region& region) {
    const auto number = std::make_shared<std::optional<uint32_t>>();
    const auto frames = [seen, operation](uint32_t segment) {
        return frames_in(operation.frames, seen.index->segments[segment]);
    };
    return {[=]() -> std::optional<uint32_t> {
                for (uint32_t next = *number ? **number + 1 : 0; next < seen.index->segments.size(); next++) {
                    *number = next;
                    if (next != seen.number && frames(next).first <= frames(next).last) return next;
                }
                return std::nullopt;
            },
            [=](const std::shared_ptr<const PaintClip>& clip, const Layer& before) {
                PaintOperation there = operation;
                there.frames = frames(**number);
                return apply_operation(clip->canvas, *before, leaves_for(clip->canvas, *before, region, there), there);
            }};
}

PaintedRegion paint_region(const PaintPlace& place, const std::shared_ptr<const PaintClip>& clip, const Layer& before,
                           PaintOperation operation, const edit::Region& region) {
    const auto painted = [&](const Layer& on) {
        return apply_operation(clip->canvas, *on, leaves_for(clip->canvas, *on, region, operation), operation);
    };
    if (!place.is_segmented()) return {painted(before), std::nullopt};
    const PaintOperation of_clip = operation;
    if (is_carried(operation.kind) && operation.frames.follow != edit::Follow::kNot) {
        operation.frames = {place.frame, place.frame};
        const auto none = std::make_shared<const voctree::EditLayer>(voctree::EditLayer{clip->field, {}});
        const CarriedPaint carried = carry_on(place, clip, before, painted(none), of_clip.frames);
        if (!carried.carrier) return {};
        return {carried.layer, spread_edits(carried.carrier)};
    }
    operation.frames = frames_in(operation.frames, place.segment());
    const bool is_seen = operation.frames.first <= operation.frames.last;
    return {is_seen ? painted(before) : nullptr, spread_region(place, of_clip, region)};
}

void start_spread(Editor& editor, JobQueue& jobs, const PaintPlace& place, uint32_t node,
                  const std::filesystem::path& layer, SpreadPaint paint) {
    std::make_shared<Spread>(editor, jobs, place, node, layer, std::move(paint))->start_next();
}

}  // namespace neuvv::editor

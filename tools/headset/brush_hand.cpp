#include "tools/headset/brush_hand.h"

#include <fmt/format.h>

#include "edit/paint_layers.h"
#include "media/colour.h"

namespace neuvv::headset {

namespace {

constexpr double kTip_m = 0.08;  // in front of the hand

editor::PaintOperation operation_of(const HandBrush& brush, float frame, uint32_t frames) {
    editor::PaintOperation operation;
    operation.kind = brush.does == HandBrush::Does::kErase ? editor::PaintOperation::Kind::kErase
                                                           : editor::PaintOperation::Kind::kColour;
    operation.colour = media::linear_from_srgb(brush.colour);
    operation.opacity = static_cast<float>(brush.opacity);
    operation.frames = {frame, frame, edit::Follow::kRun};
    if (brush.whole_clip) operation.frames = {0, static_cast<float>(frames - 1), edit::Follow::kNot};
    return operation;
}

// A tip as it stood in the performer's space: its own box is the world's, however the performer stands.
struct Tip {
    glm::dmat4 world_from_performer{1};
    glm::dvec3 from{0}, to{0};  // world: where it was moved along
    double radius_m = 0;
    HandBrush::Tip shape = HandBrush::Tip::kBall;

    bool touches(glm::vec3 place) const {
        const glm::dvec3 at = world_from_performer * glm::dvec4(place, 1), way = to - from;
        const double length = glm::dot(way, way);
        const double along = length > 0 ? glm::clamp(glm::dot(at - from, way) / length, 0.0, 1.0) : 0;
        const glm::dvec3 off = glm::abs(at - from - along * way);
        return shape == HandBrush::Tip::kBall ? glm::dot(off, off) < radius_m * radius_m
                                              : std::max({off.x, off.y, off.z}) < radius_m;
    }
};

}  // namespace

// A performer's clip on the host, and the layer that is painted.
struct BrushHand::Ready {
    uint32_t node = 0;
    std::filesystem::path clip_path, layer_path;
    bool is_new = false;  // the layer
    std::shared_ptr<const editor::PaintClip> clip;
    std::shared_ptr<const voctree::EditLayer> layer;  // as read; none where it is new, or the document has it
};

struct BrushHand::Stroke {
    uint32_t node = 0;
    std::string what;
    HandBrush brush;
    float frame = 0;  // of the clip, where it was begun
    std::vector<Tip> waiting;
    std::optional<PaintRegion> region;  // all of it, once, instead of tips
    std::optional<glm::dvec3> last;
    bool under_way = false, released = false;
    // Once its performer has been read; the jobs' own, one after the other.
    std::shared_ptr<const Ready> ready;
    std::optional<editor::PaintSession> session;
    bool region_laid = false, met = false, failed = false;

    bool waits() const { return !waiting.empty() || (region && !region_laid); }
};

glm::dvec3 BrushHand::tip_of(const xr::Pose& world_aim) {
    return world_aim * glm::dvec3(0, 0, -kTip_m);
}

// The selected performer, or the only one.
std::optional<uint32_t> BrushHand::target(const OnStage& on) {
    if (const auto selected = on.selected_performer()) return selected;
    if (on.stage->performers.size() == 1) return 0;
    says_ = "Select the performer that shall be painted";
    return std::nullopt;
}

// Its uppermost layer is painted where it is its alone, else a new one. Null while that is not known.
std::shared_ptr<const BrushHand::Ready> BrushHand::prepare(OnStage& on, uint32_t index) {
    const stage::StagePerformer& performer = on.stage->performers[index];
    const auto layers = edit::paint_layers_of(on.editor.file(), performer.node);
    if (!layers) return nullptr;
    const bool own = !layers->empty() && !edit::is_shared(on.editor.file(), performer.node, layers->back().path);
    const std::filesystem::path clip_path = on.stage->clips[performer.clip].path;
    const bool same = ready_ && ready_->node == performer.node && ready_->clip_path == clip_path &&
                      (own ? ready_->layer_path == layers->back().path
                           : ready_->is_new && !edit::used_layers(on.editor.file()).contains(ready_->layer_path) &&
                                 !on.editor.document().paint.contains(ready_->layer_path));  // undone, it is there yet
    if (same) return ready_;
    if (failed_.id == on.editor.id() && failed_.node == performer.node) {
        says_ = failed_.problem;
        return nullptr;
    }
    says_ = fmt::format("Reading {}, to be painted", performer.name);
    if (std::exchange(reading_, true)) return nullptr;
    auto ready = std::make_shared<Ready>();
    ready->node = performer.node;
    ready->clip_path = clip_path;
    ready->layer_path = own ? layers->back().path : edit::free_paint_path(on.editor.document(), performer.node);
    ready->is_new = !own;
    if (ready_ && ready_->clip_path == clip_path) ready->clip = ready_->clip;
    std::vector<std::filesystem::path> layers_to_read;
    if (own && !on.editor.document().paint.contains(ready->layer_path)) layers_to_read.push_back(ready->layer_path);
    jobs_.start(says_, [this, &on, ready, layers = std::move(layers_to_read), id = on.editor.id()]() -> JobQueue::Then {
        try {
            const auto read = editor::read_performer(ready->clip_path, ready->clip, layers);
            ready->clip = read.clip;
            if (!layers.empty()) ready->layer = read.layers.at(ready->layer_path);
        } catch (const std::exception& error) {
            return [this, &on, id, node = ready->node, problem = std::string(error.what())] {
                reading_ = false;
                failed_ = {id, node, problem};
                on.editor.notify(problem, true);
                lay(on);
            };
        }
        return [this, &on, ready] {
            reading_ = false;
            ready_ = ready;
            lay(on);
        };
    });
    return nullptr;
}

void BrushHand::update(OnStage& on, Hands& hands) {
    Hand& hand = hands[xr::kRight];
    says_.clear();
    if (on.tool != HandTool::kPaint || !hand.select.held()) end_stroke(on);
    lay(on);
    if (region_ && region_->nodes != on.editor.node_count()) region_.reset();
    if (!region_ || on.tool != HandTool::kRegion) corner_.reset();
    if (on.tool == HandTool::kArrange) return;
    const auto performer = target(on);
    if (!performer) return;
    if (strokes_.empty()) {
        if (const auto ready = prepare(on, *performer)) say_what_is_painted(on, *ready);
    }
    if (on.tool == HandTool::kRegion) return pull_region(on, *performer, hand);
    if (hand.aim && hand.takes_press() && hand.at.what != PointedAt::What::kPanel) {
        strokes_.push_back(begin(on, *performer));
        hand.feel(0.3);
    }
    draw(on, hand);
}

void BrushHand::say_what_is_painted(const OnStage& on, const Ready& ready) {
    const auto& node = on.stage->scene.nodes[ready.node];
    const auto layers = edit::paint_layers_of(on.editor.file(), ready.node);
    const bool worn = layers && !layers->empty() && layers->back().path == ready.layer_path;
    says_ = worn ? fmt::format("Paints {}, on its layer \"{}\"", node.name, edit::title_of(layers->back()))
                 : fmt::format("Paints {}, on a new layer", node.name);
}

std::shared_ptr<BrushHand::Stroke> BrushHand::begin(const OnStage& on, uint32_t index) const {
    const stage::StagePerformer& performer = on.stage->performers[index];
    auto stroke = std::make_shared<Stroke>();
    stroke->node = performer.node;
    stroke->brush = on.brush;
    stroke->what = fmt::format("{} {} in the air", performer.name,
                               on.brush.does == HandBrush::Does::kErase ? "erased" : "painted");
    for (const stage::EvaluatedPerformer& at : on.evaluated.performers)
        if (at.performer == index) stroke->frame = at.frame;
    return stroke;
}

void BrushHand::draw(OnStage& on, const Hand& hand) {
    if (strokes_.empty() || strokes_.back()->released || !hand.aim) return;
    Stroke& stroke = *strokes_.back();
    const glm::dvec3 tip = tip_of(*hand.aim);
    if (stroke.last && glm::distance(*stroke.last, tip) < 0.25 * stroke.brush.radius_m) return;
    for (const stage::EvaluatedPerformer& performer : on.evaluated.performers) {
        if (on.stage->performers[performer.performer].node != stroke.node) continue;
        stroke.waiting.push_back(
            {performer.world_from_performer, stroke.last.value_or(tip), tip, stroke.brush.radius_m, stroke.brush.tip});
        stroke.last = tip;
    }
    lay(on);
}

// The first stroke goes on, where it can.
void BrushHand::lay(OnStage& on) {
    if (strokes_.empty() || strokes_.front()->under_way) return;
    const std::shared_ptr<Stroke> stroke = strokes_.front();
    if (!stroke->ready) {
        if (on.is_behind()) return;
        for (uint32_t i = 0; i < on.stage->performers.size() && !stroke->ready; i++)
            if (on.stage->performers[i].node == stroke->node) stroke->ready = prepare(on, i);
        if (!stroke->ready && !reading_) strokes_.pop_front();  // why has been told
        if (!stroke->ready) return;
        const Ready& ready = *stroke->ready;
        if (ready.layer) on.editor.open_layer(ready.layer_path, ready.layer);
        const auto known = on.editor.document().paint.find(ready.layer_path);
        const auto before = known != on.editor.document().paint.end()
                                ? known->second
                                : std::make_shared<voctree::EditLayer>(voctree::EditLayer{ready.clip->field, {}});
        stroke->session.emplace(editor::PaintSubject{ready.clip}, before,
                                operation_of(stroke->brush, stroke->frame, ready.clip->tree.frames));
    }
    if (stroke->waits())
        lay_more(on, stroke);
    else if (stroke->released)
        finish(on);
}

void BrushHand::lay_more(OnStage& on, std::shared_ptr<Stroke> stroke) {
    stroke->under_way = true;
    edit::Region touched;
    if (stroke->region) {
        touched = edit::box_region(glm::vec3(stroke->region->low), glm::vec3(stroke->region->high));
        stroke->region_laid = true;
    } else {
        touched = [tips = std::exchange(stroke->waiting, {})](glm::vec3 place) {
            return std::any_of(tips.begin(), tips.end(), [&](const Tip& tip) { return tip.touches(place); });
        };
    }
    jobs_.start("", [this, &on, stroke, touched = std::move(touched)]() -> JobQueue::Then {
        std::shared_ptr<const voctree::EditLayer> layer;
        try {
            if (stroke->session->add_region(touched)) layer = stroke->session->layer();
        } catch (const std::exception& error) {
            return [this, &on, stroke, problem = std::string(error.what())] {
                on.editor.notify(problem, true);
                stroke->failed = true;
                finish(on);
            };
        }
        return [this, &on, stroke, layer] {
            stroke->under_way = false;
            stroke->met |= layer != nullptr;
            if (layer)
                on.editor.drag([&](edit::Document& document) {
                    return edit::set_paint(document, stroke->node, stroke->ready->layer_path, "headset", layer,
                                           stroke->what);
                });
            lay(on);
        };
    });
}

void BrushHand::finish(OnStage& on) {
    on.editor.end_drag();
    const Stroke& stroke = *strokes_.front();
    if (stroke.region_laid && !stroke.met && !stroke.failed) on.editor.notify("there is nothing in the box", true);
    strokes_.pop_front();
}

void BrushHand::end_stroke(OnStage& on) {
    if (strokes_.empty() || strokes_.back()->released) return;
    strokes_.back()->released = true;
    lay(on);
}

void BrushHand::pull_region(const OnStage& on, uint32_t index, Hand& hand) {
    if (!hand.aim) return;
    for (const stage::EvaluatedPerformer& performer : on.evaluated.performers) {
        if (performer.performer != index) continue;
        const glm::dvec3 tip = glm::inverse(performer.world_from_performer) * glm::dvec4(tip_of(*hand.aim), 1);
        if (hand.takes_press() && hand.at.what != PointedAt::What::kPanel) {
            corner_ = tip;
            hand.feel(0.3);
        }
        if (!corner_) return;
        region_ = PaintRegion{on.stage->performers[index].node, on.editor.node_count(), glm::min(*corner_, tip),
                              glm::max(*corner_, tip)};
        if (!hand.select.held()) corner_.reset();
    }
}

void BrushHand::do_region(OnStage& on) {
    const auto performer = target(on);
    if (!region_ || !performer || on.stage->performers[*performer].node != region_->node)
        return on.editor.notify("pull up a box with the trigger first", true);
    auto stroke = begin(on, *performer);
    stroke->region = region_;
    stroke->released = true;
    strokes_.push_back(std::move(stroke));
    lay(on);
}

}  // namespace neuvv::headset

#include "tools/headset/brush_hand.h"

#include <fmt/format.h>

#include "tools/viewer/layer_list.h"
#include "voctree/nvpaint.h"
#include "voctree/nvv.h"

namespace neuvv {

namespace {

constexpr double kTip_m = 0.08;  // in front of the hand

// The sRGB transfer function's inverse.
float linear(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

PaintWork work_of(const HandBrush& brush, float frame, uint32_t frames) {
    PaintWork work;
    work.kind = brush.does == HandBrush::Does::kErase ? PaintWork::Kind::kErase : PaintWork::Kind::kColour;
    work.colour = {linear(brush.colour.r), linear(brush.colour.g), linear(brush.colour.b)};
    work.opacity = static_cast<float>(brush.opacity);
    work.frames = {frame, frame, Follow::kRun};
    if (brush.whole_clip) work.frames = {0, static_cast<float>(frames - 1), Follow::kNot};
    return work;
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
    std::string name;
    std::filesystem::path clip_path, layer_path;
    bool is_new = false;  // the layer
    std::shared_ptr<const PaintClip> clip;
    std::shared_ptr<const EditLayer> layer;  // as read; none where it is new, or the document has it
};

struct BrushHand::Stroke {
    std::shared_ptr<const Ready> ready;
    PaintWork work;
    std::string what;
    std::vector<Tip> waiting;
    std::optional<glm::dvec3> last;
    bool under_way = false, released = false;
    uint64_t opened = 0;
    // The jobs' own, one after the other.
    std::shared_ptr<const EditLayer> before;
    std::vector<uint8_t> covered;  // by leaf
};

glm::dvec3 BrushHand::tip_of(const Pose& world_aim) {
    return world_aim * glm::dvec3(0, 0, -kTip_m);
}

bool BrushHand::busy() const {
    return stroke_ != nullptr;
}

// The selected performer's, or the only one's. Its uppermost layer is painted where it is its alone, else a new one.
std::shared_ptr<const BrushHand::Ready> BrushHand::prepare(OnStage& on) {
    waits_for_.clear();
    auto index = on.selected_performer();
    if (!index && on.stage->performers.size() == 1) index = 0;
    if (!index) {
        waits_for_ = "Select the performer that shall be painted";
        return nullptr;
    }
    const StagePerformer& performer = on.stage->performers[*index];
    const auto layers = layers_of(on.editor.file(), performer.node);
    if (!layers) return nullptr;
    const bool own = !layers->empty() && !is_shared(on.editor.file(), performer.node, layers->back().path);
    const std::filesystem::path clip_path = on.stage->clips[performer.clip].path;
    const bool same = ready_ && ready_->node == performer.node && ready_->clip_path == clip_path &&
                      (own ? ready_->layer_path == layers->back().path
                           : ready_->is_new && !worn_layers(on.editor.file()).contains(ready_->layer_path));
    if (same) return ready_;
    waits_for_ = fmt::format("Reading {}, to be painted", performer.name);
    if (reading_ || failed_ == on.editor.id()) return nullptr;
    reading_ = true;
    auto ready = std::make_shared<Ready>();
    ready->node = performer.node;
    ready->name = performer.name;
    ready->clip_path = clip_path;
    ready->layer_path = own ? layers->back().path : free_paint_path(on.editor.document(), performer.node);
    ready->is_new = !own;
    if (ready_ && ready_->clip_path == clip_path) ready->clip = ready_->clip;
    const bool reads_layer = own && !on.editor.document().paint.contains(ready->layer_path);
    work_.start(waits_for_, [this, &on, ready, reads_layer, id = on.editor.id()]() -> Work::Then {
        try {
            if (!ready->clip) ready->clip = std::make_shared<const PaintClip>(read_nvv(ready->clip_path));
            if (reads_layer)
                ready->layer = std::make_shared<const EditLayer>(read_paint(ready->layer_path, ready->clip->field));
        } catch (const std::exception& error) {
            return [this, &on, id, problem = std::string(error.what())] {
                reading_ = false;
                failed_ = id;
                on.editor.tell(problem, true);
            };
        }
        return [this, ready] {
            reading_ = false;
            ready_ = ready;
        };
    });
    return nullptr;
}

void BrushHand::update(OnStage& on, Hands& hands) {
    if (on.tool == HandTool::kArrange) {
        waits_for_.clear();
        corner_.reset();
        if (stroke_ && !stroke_->released) end_stroke(on);
        return;
    }
    Hand& hand = hands[kRight];
    const auto ready = prepare(on);
    if (stroke_ && !stroke_->released && (!hand.select.held() || on.tool == HandTool::kRegion)) end_stroke(on);
    if (on.tool == HandTool::kRegion) return pull_region(on, hand);
    const bool off_panel = hand.at.what != PointedAt::What::kPanel;
    wants_stroke_ = hand.select.held() && (wants_stroke_ || (hand.select.went_down() && off_panel));
    if (!stroke_ && ready && hand.aim && wants_stroke_) {  // may come later than the press, where a clip was read first
        begin(on, ready);
        wants_stroke_ = false;
        hand.feel(0.3);
    }
    if (!stroke_ || stroke_->released || !hand.aim) return;
    const glm::dvec3 tip = tip_of(*hand.aim);
    if (stroke_->last && glm::distance(*stroke_->last, tip) < 0.25 * on.brush.radius_m) return;
    for (const InstantPerformer& performer : on.instant.performers) {
        if (on.stage->performers[performer.performer].node != stroke_->ready->node) continue;
        stroke_->waiting.push_back(
            {performer.world_from_performer, stroke_->last.value_or(tip), tip, on.brush.radius_m, on.brush.tip});
        stroke_->last = tip;
    }
    go_on(on);
}

void BrushHand::begin(OnStage& on, std::shared_ptr<const Ready> ready) {
    stroke_ = std::make_shared<Stroke>();
    stroke_->ready = ready;
    float frame = 0;
    for (const InstantPerformer& performer : on.instant.performers)
        if (on.stage->performers[performer.performer].node == ready->node) frame = performer.frame;
    stroke_->work = work_of(on.brush, frame, ready->clip->tree.frames);
    stroke_->what = fmt::format("{} {} in the air", ready->name,
                                stroke_->work.kind == PaintWork::Kind::kErase ? "erased" : "painted");
    stroke_->opened = on.editor.opened();
    if (ready->layer) on.editor.open_layer(ready->layer_path, ready->layer);
    const auto& paint = on.editor.document().paint;
    const auto known = paint.find(ready->layer_path);
    stroke_->before =
        known != paint.end() ? known->second : std::make_shared<EditLayer>(EditLayer{ready->clip->field, {}});
    stroke_->covered.resize(ready->clip->tree.leaf_count);
}

// Bound by memory: all leaves' middles once a job, 12 bytes each.
void BrushHand::go_on(OnStage& on) {
    if (!stroke_ || stroke_->under_way) return;
    if (stroke_->waiting.empty()) {
        if (!stroke_->released) return;
        stroke_.reset();
        return on.editor.end_drag();
    }
    stroke_->under_way = true;
    work_.start("", [this, &on, stroke = stroke_, tips = std::exchange(stroke_->waiting, {})]() -> Work::Then {
        const Canvas& canvas = stroke->ready->clip->canvas;
        const Region touched = [&](glm::vec3 place) {
            return std::any_of(tips.begin(), tips.end(), [&](const Tip& tip) { return tip.touches(place); });
        };
        bool any = false;
        for (const ChosenLeaf& leaf : chosen_in(canvas, *stroke->before, touched, stroke->work)) {
            any |= !stroke->covered[leaf.leaf];
            stroke->covered[leaf.leaf] = 1;
        }
        std::shared_ptr<const EditLayer> layer;
        if (any) {
            std::vector<ChosenLeaf> leaves;
            for (uint32_t leaf = 0; leaf < stroke->covered.size(); leaf++)
                if (stroke->covered[leaf]) leaves.push_back({leaf});
            layer = worked_on(canvas, *stroke->before, leaves, stroke->work);
        }
        return [this, &on, stroke, layer] {
            stroke->under_way = false;
            if (stroke->opened != on.editor.opened()) {
                stroke_.reset();
                return;
            }
            if (layer)
                on.editor.drag([&](Document& document) {
                    return put_paint(document, stroke->ready->node, stroke->ready->layer_path, "headset", layer,
                                     stroke->what);
                });
            go_on(on);
        };
    });
}

void BrushHand::end_stroke(OnStage& on) {
    if (!stroke_ || stroke_->released) return;
    stroke_->released = true;
    go_on(on);
}

void BrushHand::pull_region(OnStage& on, Hand& hand) {
    const bool off_panel = hand.at.what != PointedAt::What::kPanel;
    if (!ready_ || !hand.aim) return;
    for (const InstantPerformer& performer : on.instant.performers) {
        const uint32_t node = on.stage->performers[performer.performer].node;
        if (node != ready_->node) continue;
        const glm::dvec3 tip = glm::inverse(performer.world_from_performer) * glm::dvec4(tip_of(*hand.aim), 1);
        if (hand.select.went_down() && off_panel) {
            corner_ = tip;
            hand.feel(0.3);
        }
        if (!corner_) return;
        region_ = PaintRegion{node, glm::min(*corner_, tip), glm::max(*corner_, tip)};
        if (!hand.select.held()) corner_.reset();
    }
}

void BrushHand::do_region(OnStage& on) {
    if (!region_ || !ready_ || ready_->node != region_->node || stroke_)
        return on.editor.tell("pull up a box with the trigger first", true);
    begin(on, ready_);
    const glm::vec3 low(region_->low), high(region_->high);
    stroke_->released = stroke_->under_way = true;
    work_.start("Painting the region", [this, &on, stroke = stroke_, region = box_region(low, high)]() -> Work::Then {
        const Canvas& canvas = stroke->ready->clip->canvas;
        const auto layer =
            worked_on(canvas, *stroke->before, chosen_in(canvas, *stroke->before, region, stroke->work), stroke->work);
        return [this, &on, stroke, layer] {
            stroke_.reset();
            if (stroke->opened != on.editor.opened()) return;
            if (!layer) return on.editor.tell("there is nothing in the box", true);
            on.editor.edit([&](Document& document) {
                return put_paint(document, stroke->ready->node, stroke->ready->layer_path, "headset", layer,
                                 stroke->what);
            });
        };
    });
}

}  // namespace neuvv

#include "tools/headset/hands/hand_painter.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "edit/paint_layers.h"
#include "gpu/device.h"
#include "media/colour.h"
#include "render/volume/trace.h"

namespace neuvv::headset {

namespace {

constexpr double kTipDistance_m = 0.08;  // from the hand to the tip
constexpr uint32_t kMaxImage = 512;      // pixels of a side
constexpr double kMaxJump = 3;           // of a ray's brush between two frames, in its radii

editor::PaintOperation operation_of(const HandBrush& brush, float frame, uint32_t frames) {
    editor::PaintOperation operation;
    operation.kind = brush.mode == HandBrush::Mode::kErase ? editor::PaintOperation::Kind::kErase
                                                           : editor::PaintOperation::Kind::kColour;
    operation.colour = media::linear_from_srgb(brush.colour);
    operation.opacity = static_cast<float>(brush.opacity);
    operation.frames = {frame, frame, edit::Follow::kRun};
    if (brush.whole_clip) operation.frames = {0, static_cast<float>(frames - 1), edit::Follow::kNot};
    return operation;
}

}  // namespace

// The tip of the brush as it moved between two points, with the performer's transform at that time. The tip has its
// shape in the world: a box is aligned with the world's axes, however the performer is turned.
struct TipSweep {
    glm::dmat4 world_from_performer{1};
    glm::dvec3 from{0}, to{0};  // world
    double radius_m = 0;
    HandBrush::Tip shape = HandBrush::Tip::kBall;

    bool touches(glm::vec3 position) const {
        const glm::dvec3 at = world_from_performer * glm::dvec4(position, 1), way = to - from;
        const double length = glm::dot(way, way);
        const double along = length > 0 ? glm::clamp(glm::dot(at - from, way) / length, 0.0, 1.0) : 0;
        const glm::dvec3 off = glm::abs(at - from - along * way);
        return shape == HandBrush::Tip::kBall ? glm::dot(off, off) < radius_m * radius_m
                                              : std::max({off.x, off.y, off.z}) < radius_m;
    }
};

// A performer's clip on the host, or the segment that is seen, and the layer of it that strokes paint.
struct HandPainter::PaintTarget {
    uint32_t node = 0;
    editor::PaintPlace place;
    std::filesystem::path layer_path;
    bool is_new = false;  // whether the layer is
    std::shared_ptr<const editor::PaintClip> clip;
    editor::Layer layer;  // the segment's part as read; null where the layer is new, or in the document
    std::filesystem::path file() const { return place.layer_file(layer_path); }
};

struct HandPainter::Stroke {
    uint32_t node = 0;
    std::string description;
    HandBrush brush;
    float frame = 0;  // of the clip, when the stroke began
    std::vector<TipSweep> pending;
    std::optional<PaintRegion> region;       // for a stroke that applies a region instead of tips
    std::optional<editor::PaintArea> image;  // for one that projects an image
    std::optional<glm::dvec3> last_tip;
    bool job_running = false, released = false;
    // Set once the performer has been read. After that only the jobs use the session, one at a time.
    std::shared_ptr<const PaintTarget> target;
    editor::Layer before, painted;     // the target's file when the stroke began, and now; null: as it was
    editor::PaintOperation operation;  // its frames are of the clip
    std::optional<editor::PaintSession> session;
    std::optional<editor::SpreadPaint> spread;  // on a clip in segments: what other segments get after the stroke
    bool region_applied = false, image_applied = false, changed_leaves = false, failed = false;

    bool has_pending() const { return !pending.empty() || (region && !region_applied) || (image && !image_applied); }
};

glm::dvec3 HandPainter::tip_of(const xr::Pose& world_aim) {
    return world_aim * glm::dvec3(0, 0, -kTipDistance_m);
}

std::optional<glm::dvec3> HandPainter::brush_at(const HeadsetState& state, const Hand& hand) {
    if (!hand.aim) return std::nullopt;
    if (!state.brush.uses_ray()) return tip_of(*hand.aim);
    if (!hand.hit.colour) return std::nullopt;  // the box of a performer is no surface
    const Ray ray = xr::ray_of(*hand.aim);
    return ray.origin + hand.hit.distance_m * ray.direction;
}

// Where the ray meets no surface, the next press picks.
void HandPainter::pick_colour(HeadsetState& state, Hand& hand) {
    if (!hand.hit.colour) return state.editor.notify("point at a performer to pick its colour", true);
    state.brush.colour = media::srgb_from_linear(*hand.hit.colour);
    state.brush.mode = HandBrush::Mode::kPaint;
    state.picks_colour = false;
    hand.vibrate(0.5);
}

// A job reads the image that the user has chosen, made so small that leaves are hardly smaller than its pixels.
void HandPainter::read_image(HeadsetState& state) {
    if (state.brush.mode != HandBrush::Mode::kImage || image_file_ == state.image) return;
    image_file_ = state.image;
    image_.reset();
    image_failed_ = false;
    jobs_.start("", [this, &state, file = image_file_]() -> JobQueue::Then {
        std::shared_ptr<const media::Image> image;
        std::string problem;
        try {
            const media::Image read = media::read_png(file);
            const uint32_t side = std::max(read.width, read.height);
            image = std::make_shared<const media::Image>(editor::downscaled(read, (side + kMaxImage - 1) / kMaxImage));
        } catch (const std::exception& error) {
            problem = error.what();
        }
        return [this, &state, file, image, problem] {
            if (!problem.empty()) state.editor.notify(problem, true);
            if (file != image_file_) return;
            image_ = image;
            image_failed_ = !image;
        };
    });
}

// The image's centre is where the ray meets the performer, its upper edge is the hand's, and there it is 2 radius_m
// wide.
void HandPainter::put_image(HeadsetState& state, uint32_t index, Hand& hand) {
    if (image_failed_) image_file_.clear();  // then it is read again: somebody may have mended the file
    if (!image_ || image_file_ != state.image)
        return state.editor.notify(state.image.empty() ? "choose an image on the panel" : "the image is being read",
                                   true);
    if (!hand.hit.colour || hand.hit.performer != index)
        return state.editor.notify("point at the performer that shall be painted", true);
    stage::Camera camera;
    camera.width = image_->width;
    camera.height = image_->height;
    camera.fx = camera.fy = image_->width * hand.hit.distance_m / (2 * state.brush.radius_m);
    camera.cx = 0.5 * image_->width;
    camera.cy = 0.5 * image_->height;
    camera.world_from_camera = xr::matrix_of(*hand.aim);
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers)
        if (performer.performer == index)
            camera = render::in_performer(camera, glm::mat4(performer.world_from_performer));
    auto stroke = begin_stroke(state, index);
    stroke->image.emplace();
    stroke->image->image = *image_;
    stroke->image->image_camera = camera;
    stroke->released = true;
    strokes_.push_back(std::move(stroke));
    hand.vibrate(0.5);
    process_strokes(state);
}

// The selected performer, or the only one. Empty, with a status, where it is not clear which one to paint.
std::optional<uint32_t> HandPainter::performer_to_paint(const HeadsetState& state) {
    if (const auto selected = state.selected_performer()) return selected;
    if (state.stage->performers.size() == 1) return 0;
    status_ = "Select the performer that shall be painted";
    return std::nullopt;
}

// The target at a frame of the performer's clip. Strokes paint the performer's uppermost layer where no other performer
// uses it, else a new layer. Returns null while clip and layer are being read, or where they cannot be; a job reads
// them, and calls process_strokes() when it ends.
std::shared_ptr<const HandPainter::PaintTarget> HandPainter::load_target(HeadsetState& state, uint32_t index,
                                                                         float frame) {
    const stage::StagePerformer& performer = state.stage->performers[index];
    const auto layers = edit::paint_layers_of(state.editor.file(), performer.node);
    if (!layers) return nullptr;
    const bool paints_top_layer =
        !layers->empty() && !edit::is_shared(state.editor.file(), performer.node, layers->back().path);
    const editor::PaintPlace place(state.stage->clips[performer.clip].index, frame);
    const bool same_clip = target_ && target_->place.segment().file == place.segment().file;
    const bool same =
        same_clip && target_->node == performer.node &&
        (paints_top_layer ? target_->layer_path == layers->back().path
                          : target_->is_new && !edit::used_layers(state.editor.file()).contains(target_->layer_path) &&
                                // an undone stroke stays there
                                voctree::files_of_layer(state.editor.document().paint, target_->layer_path).empty());
    if (same && target_->place.frame == place.frame) return target_;
    if (same) {
        auto target = std::make_shared<PaintTarget>(*target_);
        target->place = place;
        return target_ = target;
    }
    if (failed_target_.id == state.editor.id() && failed_target_.node == performer.node &&
        failed_target_.file == place.segment().file) {
        status_ = failed_target_.problem;
        return nullptr;
    }
    status_ = fmt::format("Reading {}, to be painted", performer.name);
    if (std::exchange(reading_, true)) return nullptr;
    auto target = std::make_shared<PaintTarget>();
    target->node = performer.node;
    target->place = place;
    target->layer_path =
        paints_top_layer ? layers->back().path : edit::free_paint_path(state.editor.document(), performer.node);
    target->is_new = !paints_top_layer;
    if (same_clip) target->clip = target_->clip;
    std::vector<std::filesystem::path> layers_to_read;
    if (paints_top_layer && !state.editor.document().paint.contains(target->file()))
        layers_to_read.push_back(target->layer_path);
    jobs_.start(status_,
                [this, &state, target, layers = std::move(layers_to_read), id = state.editor.id()]() -> JobQueue::Then {
                    try {
                        const auto read = editor::read_performer(target->place, target->clip, layers);
                        target->clip = read.clip;
                        if (!layers.empty()) target->layer = read.files.at(target->file());
                    } catch (const std::exception& error) {
                        return [this, &state, id, node = target->node, file = target->place.segment().file,
                                problem = std::string(error.what())] {
                            reading_ = false;
                            failed_target_ = {id, node, file, problem};
                            state.editor.notify(problem, true);
                            process_strokes(state);
                        };
                    }
                    return [this, &state, target] {
                        reading_ = false;
                        target_ = target;
                        process_strokes(state);
                    };
                });
    return nullptr;
}

void HandPainter::update(HeadsetState& state, Hands& hands) {
    Hand& hand = hands[xr::kRight];
    status_.clear();
    if (state.tool != HandTool::kPaint || !hand.select.is_down()) end_stroke(state);
    process_strokes(state);
    if (region_ && region_->node_count != state.editor.node_count()) region_.reset();
    if (!region_ || state.tool != HandTool::kRegion) corner_.reset();
    if (!paints(state.tool)) {
        state.picks_colour = false;
        return;
    }
    if (state.picks_colour && hand.hit.target != PointerHit::Target::kPanel && hand.consume_press())
        pick_colour(state, hand);
    const auto performer = performer_to_paint(state);
    if (!performer) return;
    const bool is_segmented = state.stage->clips[state.stage->performers[*performer].clip].index->segments.size() > 1;
    if (strokes_.empty() && is_segmented && state.clock.playing) {
        status_ =
            fmt::format("Paints {} at the time at which a stroke begins", state.stage->performers[*performer].name);
    } else if (strokes_.empty()) {
        if (const auto target = load_target(state, *performer, state.frame_of(*performer)))
            update_status(state, *target);
    }
    if (state.tool == HandTool::kRegion) return drag_region(state, *performer, hand);
    read_image(state);
    const bool pressed = hand.aim && hand.consume_press() && hand.hit.target != PointerHit::Target::kPanel;
    if (pressed && state.brush.mode == HandBrush::Mode::kImage) return put_image(state, *performer, hand);
    if (pressed) {
        strokes_.push_back(begin_stroke(state, *performer));
        hand.vibrate(0.3);
    }
    extend_stroke(state, hand);
}

void HandPainter::update_status(const HeadsetState& state, const PaintTarget& target) {
    const auto& node = state.stage->scene.nodes[target.node];
    const auto layers = edit::paint_layers_of(state.editor.file(), target.node);
    const bool has_layer = layers && !layers->empty() && layers->back().path == target.layer_path;
    status_ = has_layer ? fmt::format("Paints {}, on its layer \"{}\"", node.name, edit::title_of(layers->back()))
                        : fmt::format("Paints {}, on a new layer", node.name);
}

std::shared_ptr<HandPainter::Stroke> HandPainter::begin_stroke(const HeadsetState& state, uint32_t index) const {
    const stage::StagePerformer& performer = state.stage->performers[index];
    auto stroke = std::make_shared<Stroke>();
    stroke->node = performer.node;
    stroke->brush = state.brush;
    stroke->description = fmt::format("{} {} in the air", performer.name,
                                      state.brush.mode == HandBrush::Mode::kErase ? "erased" : "painted");
    stroke->frame = state.frame_of(index);
    return stroke;
}

void HandPainter::extend_stroke(HeadsetState& state, const Hand& hand) {
    if (strokes_.empty() || strokes_.back()->released || !hand.aim) return;
    Stroke& stroke = *strokes_.back();
    const std::optional<glm::dvec3> at = brush_at(state, hand);
    const double way_m = at && stroke.last_tip ? glm::distance(*stroke.last_tip, *at) : 0;
    // What a ray jumps over, from one surface to another, is not painted.
    if (!at || (state.brush.by_ray && way_m > kMaxJump * stroke.brush.radius_m)) stroke.last_tip.reset();
    if (!at || (stroke.last_tip && way_m < 0.25 * stroke.brush.radius_m)) return;
    const glm::dvec3 tip = *at;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (state.stage->performers[performer.performer].node != stroke.node) continue;
        if (state.brush.by_ray && performer.performer != hand.hit.performer) continue;
        stroke.pending.push_back({performer.world_from_performer, stroke.last_tip.value_or(tip), tip,
                                  stroke.brush.radius_m, stroke.brush.tip});
        stroke.last_tip = tip;
    }
    process_strokes(state);
}

void HandPainter::process_strokes(HeadsetState& state) {
    if (spreads_) spreads_->update(strokes_.empty());
    if (strokes_.empty() || strokes_.front()->job_running) return;
    const std::shared_ptr<Stroke> stroke = strokes_.front();
    if (!stroke->target) {
        if (state.is_behind()) return;
        for (uint32_t i = 0; i < state.stage->performers.size() && !stroke->target; ++i)
            if (state.stage->performers[i].node == stroke->node) stroke->target = load_target(state, i, stroke->frame);
        if (!stroke->target && !reading_) strokes_.pop_front();  // a notice has said why
        if (!stroke->target) return;
        begin_session(state, *stroke);
        if (stroke->failed) return finish_stroke(state);
    }
    if (stroke->has_pending())
        start_job(state, stroke);
    else if (stroke->released)
        finish_stroke(state);
}

// On a clip in segments, the session selects leaves of the segment that is seen, to be carried on.
void HandPainter::begin_session(HeadsetState& state, Stroke& stroke) {
    const PaintTarget& target = *stroke.target;
    const auto none = std::make_shared<const voctree::EditLayer>(voctree::EditLayer{target.clip->field, {}});
    if (target.layer) state.editor.open_layer(target.file(), target.layer);
    const auto known = state.editor.document().paint.find(target.file());
    stroke.before = known != state.editor.document().paint.end() ? known->second : none;
    stroke.operation = operation_of(stroke.brush, target.place.clip_frame(), target.place.index->frames());
    const editor::SeenPaint seen =
        editor::seen_paint(target.place, *target.clip, stroke.before, stroke.operation.frames, true);
    editor::PaintOperation operation = stroke.operation;
    operation.frames = seen.frames;
    editor::PaintSubject subject{target.clip, {}, target.place.frame, {}};
    if (!stroke.image) return void(stroke.session.emplace(std::move(subject), seen.before, operation));
    subject.paint.push_back({stroke.before, stage::PaintBlend::kNormal, 1});
    std::string problem = "its clip is not on the device yet";
    try {
        if (project_image)
            stroke.session = project_image(target.place.segment().file, subject, seen.before, operation, *stroke.image);
    } catch (const gpu::VulkanError& failure) {
        if (failure.device_lost()) {
            stroke.target.reset();  // it is begun again on the device that is made anew
            throw;
        }
        problem = failure.what();
    } catch (const RuntimeFailure& failure) {
        problem = failure.what();
    }
    stroke.failed = !stroke.session;
    if (stroke.failed) state.editor.notify(problem, true);
}

// What the stroke's performer has after `touched`, too, was painted; null where nothing new was. For jobs.
editor::Layer HandPainter::painted(Stroke& stroke, const edit::Region& touched) {
    const PaintTarget& target = *stroke.target;
    if (stroke.region) {
        editor::PaintedRegion region =
            editor::paint_region(target.place, target.clip, stroke.before, stroke.operation, touched);
        stroke.spread = std::move(region.spread);
        return region.layer;
    }
    if (!stroke.image && !stroke.session->add_region(touched)) return nullptr;
    const editor::Layer selected = stroke.session->layer();
    if (!selected) return nullptr;  // the image meets no leaf
    if (!target.place.is_segmented()) return selected;
    const editor::CarriedPaint carried =
        editor::carry_on(target.place, target.clip, stroke.before, selected, stroke.operation.frames);
    if (carried.carrier) stroke.spread = editor::spread_edits(carried.carrier);
    return carried.layer;
}

void HandPainter::start_job(HeadsetState& state, std::shared_ptr<Stroke> stroke) {
    stroke->job_running = true;
    stroke->image_applied = stroke->image.has_value();
    edit::Region touched;
    if (stroke->region) {
        touched = edit::box_region(glm::vec3(stroke->region->low), glm::vec3(stroke->region->high));
        stroke->region_applied = true;
    } else {
        touched = [tips = std::exchange(stroke->pending, {})](glm::vec3 position) {
            return std::any_of(tips.begin(), tips.end(), [&](const TipSweep& tip) { return tip.touches(position); });
        };
    }
    jobs_.start("", [this, &state, stroke, touched = std::move(touched)]() -> JobQueue::Then {
        std::shared_ptr<const voctree::EditLayer> layer;
        try {
            layer = painted(*stroke, touched);
        } catch (const std::exception& error) {
            return [this, &state, stroke, problem = std::string(error.what())] {
                state.editor.notify(problem, true);
                stroke->failed = true;
                finish_stroke(state);
            };
        }
        return [this, &state, stroke, layer] {
            stroke->job_running = false;
            stroke->changed_leaves |= layer != nullptr;
            if (layer) stroke->painted = layer;
            if (layer)
                state.editor.drag([&](edit::Document& document) {
                    return edit::set_paint(document, stroke->node, stroke->target->layer_path, "headset",
                                           {{stroke->target->file(), layer}}, stroke->description);
                });
            process_strokes(state);
        };
    });
}

void HandPainter::finish_stroke(HeadsetState& state) {
    state.editor.end_drag();
    const Stroke& stroke = *strokes_.front();
    if (stroke.spread && !stroke.failed) {
        const PaintTarget& target = *stroke.target;
        if (!spreads_) spreads_.emplace(state.editor, jobs_);
        spreads_->start(target.place, stroke.node, target.layer_path, stroke.before, stroke.painted, *stroke.spread);
    } else if (stroke.region_applied && !stroke.changed_leaves && !stroke.failed) {
        state.editor.notify("there is nothing in the box", true);
    }
    strokes_.pop_front();
}

void HandPainter::end_stroke(HeadsetState& state) {
    if (strokes_.empty() || strokes_.back()->released) return;
    strokes_.back()->released = true;
    process_strokes(state);
}

void HandPainter::drag_region(const HeadsetState& state, uint32_t index, Hand& hand) {
    if (!hand.aim) return;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (performer.performer != index) continue;
        const glm::dvec3 tip = glm::inverse(performer.world_from_performer) * glm::dvec4(tip_of(*hand.aim), 1);
        if (hand.consume_press() && hand.hit.target != PointerHit::Target::kPanel) {
            corner_ = tip;
            hand.vibrate(0.3);
        }
        if (!corner_) return;
        region_ = PaintRegion{state.stage->performers[index].node, state.editor.node_count(), glm::min(*corner_, tip),
                              glm::max(*corner_, tip)};
        if (!hand.select.is_down()) corner_.reset();
    }
}

void HandPainter::apply_region(HeadsetState& state) {
    const auto performer = performer_to_paint(state);
    if (!region_ || !performer || state.stage->performers[*performer].node != region_->node)
        return state.editor.notify("pull up a box with the trigger first", true);
    auto stroke = begin_stroke(state, *performer);
    stroke->region = region_;
    stroke->released = true;
    strokes_.push_back(std::move(stroke));
    process_strokes(state);
}

}  // namespace neuvv::headset

#include "tools/viewer/tools/paint_tool.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "editor/paint/paint_task.h"
#include "editor/pointer.h"
#include "render/volume/trace.h"
#include "tools/ui/icons.h"
#include "tools/viewer/context.h"
#include "tools/viewer/tools/overlay.h"

namespace neuvv::viewer {

namespace {

constexpr double kRadiusStep = 1.15;

constexpr const char* kDone[] = {"painted", "erased", "colours shifted", "restored", "image projected"};

}  // namespace

const ToolMode PaintTool::kMode{"tool/paint", ICON_BRUSH, "Paint (4)", GLFW_KEY_4};

// A stroke: from the press of the button until it is released and all its touches are painted.
struct PaintTool::Stroke {
    uint32_t node = 0;
    Target target;
    editor::PaintPlace place;
    std::string what;
    uint64_t document = 0;  // Editor::id() after the stroke's last change
    glm::dmat4 world_from_performer{1};
    std::vector<std::pair<stage::Camera, std::vector<glm::dvec2>>> waiting;
    // The times of the first events whose pixels wait, and whose pixels are being painted; as FrameInput::now_s.
    std::optional<double> waiting_since_s, sent_since_s;
    glm::dvec2 last{-1e9};  // the last pixel
    bool under_way = false, released = false;
    // Used by the render thread alone once the stroke has begun.
    editor::PaintSubject subject;
    editor::Layer before;  // of the session; without edits where they are carried
    editor::PaintOperation operation;
    editor::PaintArea area;
    std::optional<editor::PaintSession> session;
    editor::Layer painted;  // the target's file as the stroke has painted it; null: not at all
    // On a clip in segments, of edits that are carried: the frames of the clip, and what carries them after the stroke.
    std::optional<edit::EditFrames> carried;
    std::shared_ptr<editor::PaintCarrier> carrier;
};

std::optional<PaintedPerformer> PaintTool::performer(const Context& context) {
    if (!context.frame.stage || !context.editor.is_open()) return {};
    const std::vector<stage::StagePerformer>& all = context.frame.stage->performers;
    const auto selected = context.editor.selected();
    size_t index = all.size() == 1 ? 0 : all.size();
    for (size_t i = 0; i < all.size(); ++i)
        if (selected == all[i].node) index = i;
    if (index >= all.size() || index >= context.frame.evaluated.performers.size()) return {};
    auto layers = edit::paint_layers_of(context.editor.file(), all[index].node);
    if (!layers) return {};
    const stage::StageClip& clip = context.frame.stage->clips[all[index].clip];
    const stage::EvaluatedPerformer& evaluated = context.frame.evaluated.performers[index];
    return PaintedPerformer{all[index].node,
                            all[index].name,
                            clip.frames,
                            evaluated.frame,
                            editor::PaintPlace(clip.index, evaluated.frame),
                            evaluated.world_from_performer,
                            evaluated.visible,
                            std::move(*layers)};
}

size_t PaintTool::painted_layer(const PaintedPerformer& performer) const {
    for (size_t i = 0; i < performer.layers.size(); ++i)
        if (performer.layers[i].path == settings.layer) return i;
    return performer.layers.empty() ? 0 : performer.layers.size() - 1;
}

edit::EditFrames PaintTool::frames_of(const PaintedPerformer& performer) const {
    const auto last = static_cast<float>(performer.frames - 1);
    const float seen = performer.place.clip_frame();
    edit::EditFrames frames{seen, seen, settings.follow};
    if (settings.frames == PaintSettings::Frames::kRange) {
        const auto [first, end] = std::minmax(settings.first, settings.last);
        frames.first = std::clamp(static_cast<float>(first), 0.0f, last);
        frames.last = std::clamp(static_cast<float>(end), 0.0f, last);
    }
    if (settings.frames == PaintSettings::Frames::kAll) frames = {0, last, edit::Follow::kNot};
    return frames;
}

editor::PaintOperation PaintTool::operation_of(const PaintedPerformer& performer, bool inverted) const {
    editor::PaintOperation operation;
    using Kind = editor::PaintOperation::Kind;
    static_assert(static_cast<int>(PaintSettings::Tool::kRestore) == static_cast<int>(Kind::kRestore),
                  "the tools have Kind's order");
    if (settings.tool != PaintSettings::Tool::kStamp)
        operation.kind = static_cast<editor::PaintOperation::Kind>(settings.tool);
    if (inverted && operation.kind == editor::PaintOperation::Kind::kColour)
        operation.kind = editor::PaintOperation::Kind::kErase;
    operation.colour = glm::clamp(glm::vec3(settings.colour), 0.0f, 1.0f);
    operation.opacity = static_cast<float>(settings.opacity);
    operation.shift = {static_cast<float>(settings.hue_degrees), static_cast<float>(settings.saturation)};
    operation.frames = frames_of(performer);
    return operation;
}

editor::Layer PaintTool::layer_at(const Context& context, const std::filesystem::path& file) const {
    const auto& edited = context.editor.document().paint;
    if (const auto found = edited.find(file); found != edited.end()) return found->second;
    const auto found = read_.find(file);
    return found != read_.end() ? found->second : nullptr;
}

// Painting needs the clip, or the segment that is seen, the visible layers and the painted layer. While a clip in
// segments plays, none is read.
bool PaintTool::prepare(Context& context) {
    const auto performer = this->performer(context);
    if (!performer) return false;
    std::vector<std::filesystem::path> missing;
    const size_t painted = painted_layer(*performer);
    for (size_t i = 0; i < performer->layers.size(); ++i) {
        const edit::ListedLayer& layer = performer->layers[i];
        const bool needed = i == painted || (layer.entry.visible && layer.entry.opacity > 0);
        if (needed && !layer_at(context, performer->place.layer_file(layer.path))) missing.push_back(layer.path);
    }
    const std::filesystem::path& file = performer->place.segment().file;
    const bool has_clip = clip_ && clip_file_ == file;
    if (has_clip && missing.empty()) return true;
    if (performer->place.is_segmented() && context.view.clock.playing) return false;
    if (reading_ || failed_ == std::pair(context.editor.id(), file)) return false;
    reading_ = true;
    context.jobs.start(fmt::format("Reading {}, to be painted", performer->name),
                       [this, &context, file, place = performer->place, missing, clip = has_clip ? clip_ : nullptr,
                        id = context.editor.id()]() -> JobQueue::Then {
                           editor::ReadPerformer read;
                           try {
                               read = editor::read_performer(place, clip, missing);
                           } catch (const std::exception& error) {
                               return [this, &context, id, file, problem = std::string(error.what())] {
                                   reading_ = false;
                                   failed_ = {id, file};
                                   context.editor.notify(problem, true);
                               };
                           }
                           return [this, file, read] {
                               reading_ = false;
                               clip_file_ = file;
                               clip_ = read.clip;
                               for (const auto& [name, layer] : read.files) read_[name] = layer;
                           };
                       });
    return false;
}

editor::PaintSubject PaintTool::subject_of(const Context& context, const PaintedPerformer& performer,
                                           bool without_painted) const {
    editor::PaintSubject subject;
    subject.clip = clip_;
    subject.frame = performer.place.frame;
    const size_t painted = painted_layer(performer);
    for (size_t i = 0; i < performer.layers.size(); ++i) {
        const stage::PaintLayer& entry = performer.layers[i].entry;
        if (!entry.visible || entry.opacity <= 0 || (without_painted && i == painted)) continue;
        if (auto layer = layer_at(context, performer.place.layer_file(performer.layers[i].path)))
            subject.paint.push_back({std::move(layer), entry.blend, static_cast<float>(entry.opacity)});
    }
    return subject;
}

PaintTool::Target PaintTool::new_target(const Context& context, const PaintedPerformer& performer) const {
    const auto path = edit::free_paint_path(context.editor.document(), performer.node);
    return {path, performer.place.layer_file(path),
            std::make_shared<const voctree::EditLayer>(voctree::EditLayer{clip_->field, {}})};
}

std::optional<PaintTool::Target> PaintTool::open_target(Context& context, const PaintedPerformer& performer) {
    if (performer.layers.empty()) return new_target(context, performer);
    const edit::ListedLayer& layer = performer.layers[painted_layer(performer)];
    if (!layer.entry.visible || layer.entry.opacity <= 0) {
        context.editor.notify(fmt::format("\"{}\" is not seen: show the layer to paint on it", edit::title_of(layer)),
                              true);
        return {};
    }
    Target target{layer.path, performer.place.layer_file(layer.path), nullptr};
    target.before = layer_at(context, target.file);
    if (protected_layers_.contains(layer.path) || edit::is_shared(context.editor.file(), performer.node, layer.path)) {
        // A copy for this performer alone. Of a clip in segments, whose files are not all read, a new layer over it.
        Target own = new_target(context, performer);
        if (performer.place.is_segmented()) return own;
        own.before = target.before;
        unshared_ = {own.path, target.path};
        return own;
    }
    context.editor.open_layer(target.file, target.before);
    read_.erase(target.file);  // from now on the editor has it
    return target;
}

void PaintTool::handle_key(Context& context, const ui::KeyPress& press) {
    if (press.key == GLFW_KEY_B && !press.control && !press.alt) context.view.mode = &kMode;
}

void PaintTool::set_radius_by_keys(const Context& context) {
    if (!is_current(context) || ImGui::GetIO().WantTextInput) return;
    for (const char32_t character : context.frame.typed) {
        if (character == U'[') settings.radius_m /= kRadiusStep;
        if (character == U']') settings.radius_m *= kRadiusStep;
    }
    settings.radius_m = std::clamp(settings.radius_m, kMinRadius_m, kMaxRadius_m);
}

void PaintTool::handle_pointer(Context& context, PointerUse& use) {
    if (spreads_) spreads_->update(!busy());
    set_radius_by_keys(context);
    const auto performer = this->performer(context);
    ready_ = is_current(context) && performer && performer->visible && prepare(context);
    if (stroke_) {
        continue_stroke(context);
        if (performer) draw_brush(context, *performer);
        use = {true, true, true};
        return;
    }
    if (!ready_) return;
    const bool is_stamp = settings.tool == PaintSettings::Tool::kStamp;
    if (settings.in_box && !is_stamp)
        use.left |= drag_box(context, *performer, use.left);
    else
        click_or_hover(context, *performer, use);
}

void PaintTool::click_or_hover(Context& context, const PaintedPerformer& performer, PointerUse& use) {
    const ImGuiIO& io = ImGui::GetIO();
    const bool is_stamp = settings.tool == PaintSettings::Tool::kStamp, over = context.frame.pointer_in_image;
    const bool free = over && !io.KeyShift && !use.left;
    const bool clicked = free && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !busy();
    if (over && !context.view.clock.playing) update_hover(context, performer);
    if (free && (!is_stamp || stamp_loaded())) use.left = true;
    if (clicked && io.KeyAlt) {
        take_colour(context);
    } else if (is_stamp) {
        use.wheel = over && io.KeyCtrl;
        if (use.wheel && io.MouseWheel != 0)
            settings.stamp_share =
                std::clamp(settings.stamp_share * std::pow(1.1, double{io.MouseWheel}), kMinStamp, kMaxStamp);
        if (clicked && stamp_loaded()) project_stamp(context, performer);
        if ((over || task_runs_) && stamp_loaded()) draw_stamp(context);
    } else {
        if (clicked) begin_stroke(context, performer);
        if (over) draw_brush(context, performer);
    }
}

void PaintTool::begin_stroke(Context& context, const PaintedPerformer& performer) {
    auto active = std::make_shared<Stroke>();
    const auto target = open_target(context, performer);
    if (!target) return;
    active->target = *target;
    active->before = target->before;
    context.view.clock.pause();
    active->operation = operation_of(performer, ImGui::GetIO().KeyCtrl);
    const editor::SeenPaint seen = editor::seen_paint(performer.place, *clip_, target->before, active->operation.frames,
                                                      editor::is_carried(active->operation.kind));
    if (!seen.has_frames()) {
        context.editor.notify("the frames are in other segments: go to one of them", true);
        return;
    }
    if (seen.is_carried) active->carried = active->operation.frames;
    active->operation.frames = seen.frames;
    active->before = seen.before;
    active->what = kDone[static_cast<size_t>(active->operation.kind)];
    active->node = performer.node;
    active->place = performer.place;
    active->document = context.editor.id();
    active->world_from_performer = performer.world_from_performer;
    active->subject = subject_of(context, performer, active->operation.kind == editor::PaintOperation::Kind::kRestore);
    active->area.radius_m = static_cast<float>(settings.radius_m);
    active->area.hardness = static_cast<float>(settings.hardness);
    stroke_ = std::move(active);
    continue_stroke(context);
}

// Called once a frame: adds the pixel of the pointer to those that wait, and sends these once the last ones are
// painted.
void PaintTool::continue_stroke(Context& context) {
    Stroke& stroke = *stroke_;
    if (context.frame.escape) {
        context.editor.cancel_drag();
        stroke_.reset();
        return;
    }
    stroke.released |= !ImGui::IsMouseDown(ImGuiMouseButton_Left);
    const glm::dvec2 at = pointer_of(context);
    if (!stroke.released && at != stroke.last) {
        const stage::Camera camera = render::in_performer(context.frame.camera, glm::mat4(stroke.world_from_performer));
        if (stroke.waiting.empty() || stroke.waiting.back().first.world_from_camera != camera.world_from_camera)
            stroke.waiting.emplace_back(camera, std::vector<glm::dvec2>{});
        stroke.waiting.back().second.push_back(at);
        if (!stroke.waiting_since_s) stroke.waiting_since_s = context.frame.event_s;
        stroke.last = at;
    }
    context.redraw();
    if (stroke.under_way) return;
    if (stroke.waiting.empty()) {
        if (!stroke.released) return;
        if (stroke.carrier)
            spreads(context).start(stroke.place, stroke.node, stroke.target.path, stroke.target.before, stroke.painted,
                                   editor::spread_edits(stroke.carrier));
        stroke_.reset();
        return;
    }
    stroke.under_way = true;
    stroke.sent_since_s = std::exchange(stroke.waiting_since_s, std::nullopt);
    editor::post_paint_task(
        context.parts(), surface_, stroke.place.segment().file, stroke.subject.clip,
        [this, &context, active = stroke_, waiting = std::exchange(stroke.waiting, {})](
            editor::PaintSurface& surface, const std::shared_ptr<const render::Field>& field) -> JobQueue::Then {
            if (!active->session) {
                active->subject.field = field;
                active->session.emplace(active->subject, active->before, active->operation, active->area);
            }
            for (const auto& [camera, pixels] : waiting) active->session->add_touches(surface, camera, pixels);
            editor::Layer layer = active->session->layer();
            if (active->carried) {
                const editor::CarriedPaint carried = editor::carry_on(active->place, active->subject.clip,
                                                                      active->target.before, layer, *active->carried);
                layer = carried.layer;
                active->carrier = carried.carrier;
            }
            return [this, &context, active, layer] { apply_result(context, active, layer); };
        },
        [this, &context, active = stroke_] {
            clip_.reset();
            if (stroke_ == active) stroke_.reset();
        });
}

void PaintTool::apply_result(Context& context, const std::shared_ptr<Stroke>& active,
                             std::shared_ptr<const voctree::EditLayer> layer) {
    active->under_way = false;
    if (stroke_ != active) return;
    if (context.editor.id() != active->document) {  // something else has changed the document: the stroke ends
        stroke_.reset();
        return;
    }
    if (!layer) return;
    if (active->sent_since_s) context.requests.earlier_event_s = active->sent_since_s;
    context.editor.drag([&](edit::Document& document) {
        return write_layer(document, active->node, active->target, layer, active->what);
    });
    settings.layer = active->target.path;
    active->painted = layer;
    active->document = context.editor.id();
}

// Finds the surface under the pointer, whose depth gives the size of the brush.
void PaintTool::update_hover(Context& context, const PaintedPerformer& performer) {
    const glm::dvec2 pixel = pointer_of(context);
    const bool same = pixel == hover_.pixel && performer.frame == hover_.frame &&
                      context.frame.camera.world_from_camera == hover_.camera.world_from_camera;
    if (same || hover_.under_way || busy()) return;
    hover_.under_way = true;
    hover_.pixel = pixel;
    hover_.frame = performer.frame;
    hover_.camera = context.frame.camera;
    const bool restores = settings.tool == PaintSettings::Tool::kRestore;
    editor::post_paint_task(
        context.parts(), surface_, performer.place.segment().file, clip_,
        [this, &context, subject = subject_of(context, performer, restores), pixel, camera = context.frame.camera,
         world_from_performer = performer.world_from_performer](
            editor::PaintSurface& surface,
            const std::shared_ptr<const render::Field>& field) mutable -> JobQueue::Then {
            subject.field = field;
            surface.show(subject);
            const auto point = surface.surface_at(render::in_performer(camera, glm::mat4(world_from_performer)), pixel);
            return [this, &context, point, camera, world_from_performer] {
                hover_.under_way = false;
                hover_.world.reset();
                if (!point) return;
                hover_.world = glm::dvec3(world_from_performer * glm::dvec4(*point, 1));
                hover_.depth_m = editor::depth_of(camera, *hover_.world);
                context.redraw(1);
            };
        },
        [this] {
            clip_.reset();
            hover_.under_way = false;
        });
}

// A task lasts until write_result().
void PaintTool::begin_task(const Context& context) {
    task_runs_ = true;
    task_document_ = {context.editor.open_count(), context.editor.node_count()};
}

void PaintTool::write_result(Context& context, const PaintedPerformer& performer, const Target& target,
                             const editor::Layer& layer, const std::string& what,
                             std::optional<editor::SpreadPaint> spread) {
    task_runs_ = false;
    if (task_document_ != std::pair(context.editor.open_count(), context.editor.node_count())) {
        context.editor.notify("the stage is another now: nothing was painted", true);
        return;
    }
    if (!layer && !spread) {
        context.editor.notify("nothing is there: nothing was painted", true);
        return;
    }
    const auto now = layer_at(context, target.file);
    if (now && now != target.before) {
        context.editor.notify("the layer was painted meanwhile: it stays as it is", true);
        return;
    }
    if (layer && !context.editor.edit([&](edit::Document& document) {
            return write_layer(document, performer.node, target, layer, what);
        }))
        return;
    settings.layer = target.path;
    if (spread) spreads(context).start(performer.place, performer.node, target.path, target.before, layer, *spread);
}

editor::PaintSpreads& PaintTool::spreads(Context& context) {
    if (!spreads_) spreads_.emplace(context.editor, context.jobs);
    return *spreads_;
}

// A copy of a shared layer replaces that layer first.
std::string PaintTool::write_layer(edit::Document& document, uint32_t node, const Target& target,
                                   const editor::Layer& layer, const std::string& what) const {
    const auto layers = edit::paint_layers_of(document.file, node).value_or(std::vector<edit::ListedLayer>{});
    const auto at = [&](const std::filesystem::path& of) {
        return std::find_if(layers.begin(), layers.end(),
                            [&](const edit::ListedLayer& listed) { return listed.path == of; });
    };
    if (target.path == unshared_.first && at(target.path) == layers.end() && at(unshared_.second) != layers.end())
        edit::unshare_paint(document, node, static_cast<size_t>(at(unshared_.second) - layers.begin()), target.path,
                            layer);
    return edit::set_paint(document, node, target.path, "paint", {{target.file, layer}}, what);
}

// This needs no device, so a job does it. Edits that follow leaves are carried from those of the segment that is seen;
// else each segment has leaves of its own in the box.
void PaintTool::paint_in_box(Context& context) {
    const auto performer = this->performer(context);
    if (!performer || busy() || !prepare(context)) return;
    const auto target = open_target(context, *performer);
    if (!target) return;
    begin_task(context);
    const editor::PaintOperation operation = operation_of(*performer, false);
    const edit::Region box = edit::box_region(glm::vec3(settings.box_low), glm::vec3(settings.box_high));
    context.jobs.start("Painting in the box",
                       [=, this, &context, clip = clip_, performer = *performer, target = *target]() -> JobQueue::Then {
                           const editor::PaintedRegion painted =
                               editor::paint_region(performer.place, clip, target.before, operation, box);
                           return [=, this, &context] {
                               write_result(context, performer, target, painted.layer,
                                            fmt::format("{} in a box", kDone[static_cast<size_t>(operation.kind)]),
                                            painted.spread);
                           };
                       });
}

void PaintTool::add_layer(Context& context) {
    const auto performer = this->performer(context);
    if (!performer || busy() || !prepare(context)) return;
    const Target target = new_target(context, *performer);
    const std::string name = fmt::format("paint {}", performer->layers.size() + 1);
    if (context.editor.edit([&](edit::Document& document) {
            return edit::set_paint(document, performer->node, target.path, name, {{target.file, target.before}},
                                   fmt::format("new layer \"{}\"", name));
        }))
        settings.layer = target.path;
}

}  // namespace neuvv::viewer

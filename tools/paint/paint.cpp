// neuvv paint: makes and changes layers of paint on a performer.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/file_lock.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "editor/paint/paint_carrier.h"
#include "tools/commands.h"
#include "tools/paint/paint_segments.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/stage/stage_verbs.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::tools {

namespace {

// The surface that is painted on, on a device that is opened when it is needed first. The performer is one segment
// after the other.
class OnDevice {
  public:
    explicit OnDevice(const CommonOptions& common) : common_(common) {}

    editor::PaintSession session(const PaintedSegment& segment, Layer before, editor::PaintOperation operation,
                                 editor::PaintArea area) {
        if (!device_) device_.emplace(common_.device);
        if (!surface_) surface_.emplace(*device_);
        surface_->clear();
        field_.reset();
        field_ = std::make_shared<const render::Field>(
            render::upload_field(*device_, segment.clip->tree, render::WeightPrecision::kHalf));
        editor::PaintSubject subject = segment.subject();
        subject.field = field_;
        return {std::move(subject), std::move(before), std::move(operation), std::move(area)};
    }
    editor::PaintSurface& surface() { return *surface_; }

  private:
    const CommonOptions& common_;
    std::optional<gpu::Device> device_;
    std::shared_ptr<const render::Field> field_;  // what the last session paints on
    std::optional<editor::PaintSurface> surface_;
};

// A Painting onto whole frames.
Layer projected_on_each(editor::PaintSession session, editor::PaintSurface& surface, bool with_progress) {
    const auto [first, last] = session.projected_frames();
    if (first > last) return nullptr;
    std::optional<Progress> progress;
    if (with_progress) progress.emplace("project", last - first + 1);
    for (uint32_t done = 1, more = 1; more; ++done) {
        if (stop_requested()) throw RuntimeFailure("stopped before the end");
        more = session.add_projection(surface);
        if (progress) progress->update(done);
    }
    return session.layer();
}

// Needs no device.
Layer filled(const PaintedSegment& segment, const Layer& before, const PaintOptions& options,
             const editor::PaintOperation& operation) {
    editor::PaintSession session(segment.subject(), before, operation);
    session.add_region(region_of(options));
    return session.layer();
}

// The stage, and the layer's entry there.
nlohmann::ordered_json stage_json(const StagedPerformer& staged) {
    const bool listed = staged.layer < staged.performer().settings.paint.size();
    return {{"file", staged.stage.file.path.string()},
            {"node", staged.performer().node},
            {"name", staged.performer().name},
            {"layer", listed ? nlohmann::ordered_json(staged.layer) : nlohmann::ordered_json()},
            {"added", !staged.change.empty()}};
}

void print_layer(const PaintOptions& options, const PaintedScene& scene, const LayerTotals& totals) {
    if (!options.json) {
        const std::string segments =
            scene.is_segmented() ? fmt::format("in {} of {} segments, ", totals.segments, scene.index.segments.size())
                                 : "";
        tell(
            "{}: {}{} edits, each of a leaf and some frames; {} of {} leaves have any: {} colours, {} densities, {} "
            "erased\n",
            options.layer, segments, totals.edits, totals.leaves, totals.field_leaves, totals.colours, totals.densities,
            totals.erased);
        return;
    }
    nlohmann::ordered_json json = {{"file", options.layer},
                                   {"edits", totals.edits},
                                   {"leaves", totals.leaves},
                                   {"colours", totals.colours},
                                   {"densities", totals.densities},
                                   {"erased", totals.erased},
                                   {"field_leaves", totals.field_leaves},
                                   {"frames", scene.index.frames()}};
    if (scene.is_segmented()) json["segments"] = totals.segments;
    if (scene.staged) json["stage"] = stage_json(*scene.staged);
    tell("{}", json_text(json));
}

// Saves the stage and prints what the layer holds now; of a clip in segments, in those that were painted.
void finish(const PaintOptions& options, const PaintedScene& scene, const LayerTotals& totals) {
    scene.save_stage(options);
    print_layer(options, scene, totals);
    if (scene.staged && !scene.staged->change.empty() && !options.json)
        tell("{}: {}\n", options.scene, scene.staged->change);
}

// Paints a clip that is one file. Returns whether there was any leaf to paint.
bool paint_file(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
                const Painting& painting, LayerTotals& totals) {
    PaintedSegment segment(scene, options, 0);
    const Layer painted = painting(segment, segment.layer, frames);
    if (painted) {
        segment.layer = painted;
        segment.save();
    }
    totals.add(*segment.layer);
    return painted != nullptr;
}

void paint(PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames, Spread spread,
           const Painting& painting) {
    LayerTotals totals;
    const bool painted = scene.is_segmented() ? paint_segments(scene, options, frames, spread, painting, totals)
                                              : paint_file(scene, options, frames, painting, totals);
    if (painted) {
        finish(options, scene, totals);
        return;
    }
    say("no leaf is there: nothing is painted, and nothing written\n");
    scene.drop_new_layer();
    print_layer(options, scene, totals);
}

// The layer's path, once its folder is there for the lock.
const std::string& layer_to_edit(const PaintOptions& options) {
    prepare_output_folder("layer", link_target(options.layer).parent_path());
    return options.layer;
}

// Of a clip in segments, an image that is projected once is carried to the other segments.
void project(const PaintOptions& options, const CommonOptions& common) {
    catch_stop_signals();
    const EditLock lock(layer_to_edit(options), says_that_it_waits(options.layer));
    PaintedScene scene(options);
    const edit::EditFrames frames = frames_of(options, scene.at, scene.index.frames());
    if (options.every_frame && std::ceil(frames.first) > std::floor(frames.last))
        throw InputError("--frames", fmt::format("{}:{}", frames.first, frames.last), "has no whole frame",
                         "--every-frame projects on whole ones");
    const media::Image image = media::read_png(options.image);
    OnDevice on_device(common);
    const auto painting = [&](const PaintedSegment& segment, const Layer& before, const edit::EditFrames& at) {
        editor::PaintArea area = area_of(options);
        area.image = image;
        area.image_camera = camera_of(options, scene, segment.clip_box, {image.width, image.height});
        area.every_frame = options.every_frame;
        editor::PaintOperation operation;
        operation.opacity = static_cast<float>(options.alpha);
        operation.frames = at;
        editor::PaintSession session = on_device.session(segment, before, operation, std::move(area));
        if (options.every_frame)
            return projected_on_each(std::move(session), on_device.surface(), !scene.is_segmented());
        session.add_projection(on_device.surface());
        return session.layer();
    };
    paint(scene, options, frames, options.every_frame ? Spread::kEach : Spread::kCarried, painting);
}

void brush(const PaintOptions& options, const CommonOptions& common) {
    expect_change(options);
    const EditLock lock(layer_to_edit(options), says_that_it_waits(options.layer));
    PaintedScene scene(options);
    const std::vector<glm::dvec2> line = line_of(options);
    OnDevice on_device(common);
    const auto painting = [&](const PaintedSegment& segment, const Layer& before, const edit::EditFrames& at) {
        const stage::Camera camera = camera_of(options, scene, segment.clip_box, image_size(options, scene));
        editor::PaintSession session = on_device.session(segment, before, operation_of(options, at), area_of(options));
        session.add_touches(on_device.surface(), camera, line);
        return session.layer();
    };
    paint(scene, options, frames_of(options, scene.at, scene.index.frames()), Spread::kCarried, painting);
}

// Of a clip in segments, each segment has leaves of its own in the region; but where edits follow leaves, the region is
// one of the segment that is seen.
void fill(const PaintOptions& options) {
    expect_region(options);
    expect_change(options);
    const EditLock lock(layer_to_edit(options), says_that_it_waits(options.layer));
    PaintedScene scene(options);
    const edit::EditFrames frames = frames_of(options, scene.at, scene.index.frames());
    const bool follows = frames.follow != edit::Follow::kNot;
    paint(scene, options, frames, follows ? Spread::kCarried : Spread::kEach,
          [&](const PaintedSegment& segment, const Layer& before, const edit::EditFrames& at) {
              return filled(segment, before, options, operation_of(options, at));
          });
}

void restore(const PaintOptions& options) {
    expect_region(options);
    const EditLock lock(options.layer, says_that_it_waits(options.layer));
    const PaintedScene scene(options, PaintedScene::Use::kRead);
    if (!scene.is_segmented()) prepare_output_file("layer", options.layer);
    const edit::EditFrames frames = frames_of(options, scene.at, scene.index.frames());
    LayerTotals totals;
    for (const uint32_t number : painted_segments(scene, options)) {
        editor::PaintOperation operation;
        operation.kind = editor::PaintOperation::Kind::kRestore;
        operation.frames = editor::frames_in(frames, scene.index.segments[number]);
        if (operation.frames.first > operation.frames.last) continue;
        PaintedSegment segment(scene, options, number);
        if (const Layer restored = filled(segment, segment.layer, options, operation)) segment.layer = restored;
        segment.save();
        totals.add(*segment.layer);
    }
    finish(options, scene, totals);
}

void print_info(const PaintOptions& options) {
    const PaintedScene scene(options, PaintedScene::Use::kRead);
    LayerTotals totals;
    for (const uint32_t number : painted_segments(scene, options))
        totals.add(*PaintedSegment(scene, options, number).layer);
    print_layer(options, scene, totals);
}

void add_project(Command paints, const std::shared_ptr<PaintOptions>& options, const CommonOptions& common) {
    Command verb = paints.add_verb("project", "An image, from a camera, onto what the camera sees");
    add_scene_options(verb, *options);
    verb.add_option("--image", options->image, "The PNG; where it is transparent, nothing is painted").required();
    add_camera_options(verb, *options);
    add_alpha_option(verb, *options);
    add_region_options(verb, *options);
    add_frame_options(verb, *options);
    Option follow = add_follow_option(verb, *options);
    verb.add_flag("--every-frame", options->every_frame,
                  "Onto each of --frames as it is then, as a projector would: nothing is left bare when the performer "
                  "moves. On a stage it stands as at --time")
        .excludes(follow);
    verb.callback([options, &common] { project(*options, common); });
}

void add_brush(Command paints, const std::shared_ptr<PaintOptions>& options, const CommonOptions& common) {
    Command verb = paints.add_verb("brush", "A stroke of a round brush along the surface");
    add_scene_options(verb, *options);
    add_brush_options(verb, *options);
    verb.add_option("--colour,--color", options->colour, "'#rrggbb' or a name");
    add_density_option(verb, *options);
    add_camera_options(verb, *options);
    add_alpha_option(verb, *options);
    add_region_options(verb, *options);
    add_frame_options(verb, *options);
    add_follow_option(verb, *options);
    verb.callback([options, &common] { brush(*options, common); });
}

void add_region(Command paints, const std::shared_ptr<PaintOptions>& options) {
    Command verb = paints.add_verb("region", "All leaves of a region: a colour, another hue, a density");
    add_scene_options(verb, *options);
    Option colour = verb.add_option("--colour,--color", options->colour, "'#rrggbb' or a name");
    Option follow = add_follow_option(verb, *options);
    verb.add_option("--hue", options->hue, "Degrees that hues turn by, at each frame from what they are then")
        .number_between(-360, 360)
        .excludes(colour)
        .excludes(follow);
    verb.add_option("--saturation", options->saturation, "What saturation is multiplied by")
        .number_between(0, 100)
        .excludes(colour)
        .excludes(follow);
    add_alpha_option(verb, *options);
    add_density_option(verb, *options);
    add_region_options(verb, *options);
    add_frame_options(verb, *options);
    verb.callback([options] { fill(*options); });
}

void add_erase_and_restore(Command paints, const std::shared_ptr<PaintOptions>& options) {
    Command erase = paints.add_verb("erase", "All leaves of a region: no density");
    Command back = paints.add_verb("restore", "Takes the layer's edits of a region out, at --frames");
    for (Command verb : {erase, back}) {
        add_scene_options(verb, *options);
        add_region_options(verb, *options);
        add_frame_options(verb, *options);
    }
    add_follow_option(erase, *options);
    erase.callback([options] {
        options->density = 0;
        fill(*options);
    });
    back.callback([options] { restore(*options); });
}

void add_info(Command paints, const std::shared_ptr<PaintOptions>& options) {
    Command verb = paints.add_verb("info", "What the layer holds");
    add_scene_options(verb, *options);
    verb.callback([options] { print_info(*options); });
}

}  // namespace

void add_paint(Command app, CommonOptions& common) {
    Command verb = app.add_verb("paint", "Paint a scene: a layer of edits beside it, which stays as it is");
    const auto options = std::make_shared<PaintOptions>();
    verb.require_verb();
    add_project(verb, options, common);
    add_brush(verb, options, common);
    add_region(verb, options);
    add_erase_and_restore(verb, options);
    add_info(verb, options);
    verb.footer(
        {"`neuvv render --paint` shows layers of a .nvv. On a stage the performer is painted where it stands at\n"
         "--time, as its layers show it then, whatever stands before it; a layer that is not in its list yet "
         "becomes\n"
         "the uppermost one there. Copies have lists of their own, but a file that is in several shows on all.\n"
         "A layer of a clip in segments is a folder. What is painted goes on in all segments of --frames or "
         "--follow.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv paint region work/performer.nvv work/look.nvpaint --box -1,0,-1,1,0.9,1 --hue 120\n"
         "  neuvv paint brush work/performer.nvv work/look.nvpaint --line 300,200 420,220 --colour '#d02020' "
         "--follow all\n"
         "  neuvv paint project work/performer.nvv work/logo.nvpaint --image tools/performer/starry.png "
         "--every-frame "
         "--box -1,0.8,-1,1,1.5,1\n"
         "  neuvv paint info work/performer.nvv work/look.nvpaint\n"
         "  neuvv render work/performer.nvv -o work/turn.mp4 --paint work/look.nvpaint,work/logo.nvpaint:tint\n"
         "  neuvv stage new work/show.gltf\n"
         "  neuvv stage add work/show.gltf work/performer.nvv --name anna --turn 0,30,0 --scale 1,1.2,1\n"
         "  neuvv paint brush work/show.gltf work/anna.nvpaint --node anna --time 1.5 --camera camera --size "
         "1280x720 "
         "--line 600,380 680,380 --colour '#d02020' --follow run"});
}

}  // namespace neuvv::tools

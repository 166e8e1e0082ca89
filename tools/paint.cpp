// neuvv paint: makes and changes layers of paint on a performer.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "tools/commands.h"
#include "tools/paint.h"
#include "tools/report.h"
#include "voctree/nvpaint.h"

namespace neuvv::tools {

namespace {

// The performer on the device, ready to be painted.
struct DeviceScene {
    DeviceScene(const PaintedScene& scene, const CommonOptions& common)
        : device(common.device),
          field(std::make_shared<const render::Field>(
              render::upload_field(device, scene.clip->tree, render::WeightPrecision::kHalf))),
          surface(device) {}
    editor::PaintSession session(const PaintedScene& scene, editor::PaintOperation operation,
                                 editor::PaintArea area) const {
        editor::PaintSubject subject = scene.subject();
        subject.field = field;
        return {std::move(subject), scene.layer, std::move(operation), std::move(area)};
    }
    gpu::Device device;
    std::shared_ptr<const render::Field> field;
    editor::PaintSurface surface;
};

// Each of the functions that paint returns the painted layer, or null where there was no leaf to paint.
using Layer = std::shared_ptr<const voctree::EditLayer>;

Layer projected(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
                const CommonOptions& common) {
    catch_stop_signals();
    editor::PaintArea area = area_of(options);
    area.image = media::read_png(options.image);
    area.image_camera = camera_of(options, scene, {area.image.width, area.image.height});
    area.every_frame = options.every_frame;
    editor::PaintOperation operation;
    operation.opacity = static_cast<float>(options.alpha);
    operation.frames = frames;
    DeviceScene on_device(scene, common);
    editor::PaintSession session = on_device.session(scene, operation, std::move(area));
    if (!options.every_frame) {
        session.add_projection(on_device.surface);
        return session.layer();
    }
    const auto [first, last] = session.projected_frames();
    if (first > last)
        throw InputError("--frames", fmt::format("{}:{}", frames.first, frames.last), "has no whole frame",
                         "--every-frame projects on whole ones");
    Progress progress("project", last - first + 1);
    for (uint32_t done = 1, more = 1; more; done++) {
        if (stop_requested()) throw RuntimeFailure("stopped before the end");
        more = session.add_projection(on_device.surface);
        progress.update(done);
    }
    return session.layer();
}

Layer brushed(const PaintedScene& scene, const PaintOptions& options, const edit::EditFrames& frames,
              const CommonOptions& common) {
    expect_change(options);
    const std::vector<glm::dvec2> line = line_of(options);
    const stage::Camera camera = camera_of(options, scene, image_size(options, scene));
    DeviceScene on_device(scene, common);
    editor::PaintSession session = on_device.session(scene, operation_of(options, frames), area_of(options));
    session.add_touches(on_device.surface, camera, line);
    return session.layer();
}

// Needs no device.
Layer filled(const PaintedScene& scene, const PaintOptions& options, const editor::PaintOperation& operation) {
    editor::PaintSession session(scene.subject(), scene.layer, operation);
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

void print_layer(const PaintOptions& options, const PaintedScene& scene) {
    const voctree::EditLayer& layer = *scene.layer;
    std::map<uint32_t, size_t> of_leaf;
    size_t colours = 0, densities_set = 0, erased = 0;
    for (const voctree::LeafEdit& edit : layer.edits) {
        of_leaf[edit.leaf]++;
        colours += edit.alpha > 0;
        densities_set += edit.sigma > 0;
        erased += edit.sigma == 0;
    }
    if (!options.json) {
        fmt::print(
            "{}: {} edits, each of a leaf and some frames; {} of {} leaves have any: {} colours, {} densities, {} "
            "erased\n",
            options.layer, layer.edits.size(), of_leaf.size(), layer.field.leaf_count, colours, densities_set, erased);
        return;
    }
    nlohmann::ordered_json json = {{"file", options.layer},
                                   {"edits", layer.edits.size()},
                                   {"leaves", of_leaf.size()},
                                   {"colours", colours},
                                   {"densities", densities_set},
                                   {"erased", erased},
                                   {"field_leaves", layer.field.leaf_count},
                                   {"frames", layer.field.frames}};
    if (scene.staged) json["stage"] = stage_json(*scene.staged);
    fmt::print("{}", json_text(json));
}

// Saves the scene and prints what the layer holds now.
void finish(const PaintOptions& options, const PaintedScene& scene) {
    scene.save(options);
    print_layer(options, scene);
    if (scene.staged && !scene.staged->change.empty() && !options.json)
        fmt::print("{}: {}\n", options.scene, scene.staged->change);
}

// A function that paints.
using Painting = std::function<Layer(const PaintedScene&, const edit::EditFrames&)>;

void paint(const PaintOptions& options, const Painting& painting) {
    prepare_output_file("layer", options.layer);
    PaintedScene scene(options);
    const edit::EditFrames frames = frames_of(options, scene.at, scene.clip->tree.frames);
    const Layer painted = painting(scene, frames);
    if (!painted) {
        fmt::print(stderr, "no leaf is there: nothing is painted, and nothing written\n");
        scene.drop_new_layer();
        print_layer(options, scene);
        return;
    }
    scene.layer = painted;
    finish(options, scene);
}

void restore(const PaintOptions& options) {
    expect_region(options);
    PaintedScene scene(options, PaintedScene::Use::kRead);
    prepare_output_file("layer", options.layer);
    editor::PaintOperation operation;
    operation.kind = editor::PaintOperation::Kind::kRestore;
    operation.frames = frames_of(options, scene.at, scene.clip->tree.frames);
    if (const Layer restored = filled(scene, options, operation)) scene.layer = restored;
    finish(options, scene);
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
    verb.callback([options, &common] {
        paint(*options, [&](const PaintedScene& scene, const edit::EditFrames& frames) {
            return projected(scene, *options, frames, common);
        });
    });
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
    verb.callback([options, &common] {
        paint(*options, [&](const PaintedScene& scene, const edit::EditFrames& frames) {
            return brushed(scene, *options, frames, common);
        });
    });
}

void fill(const PaintOptions& options) {
    expect_region(options);
    expect_change(options);
    paint(options, [&](const PaintedScene& scene, const edit::EditFrames& frames) {
        return filled(scene, options, operation_of(options, frames));
    });
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
    verb.callback([options] { print_layer(*options, PaintedScene(*options, PaintedScene::Use::kRead)); });
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
         "the uppermost one there. Copies have lists of their own, but a file that is in several shows on all.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv paint region build/performer.nvv build/look.nvpaint --box -1,0,-1,1,0.9,1 --hue 120\n"
         "  neuvv paint brush build/performer.nvv build/look.nvpaint --line 300,200 420,220 --colour '#d02020' "
         "--follow all\n"
         "  neuvv paint project build/performer.nvv build/logo.nvpaint --image tools/performer/starry.png "
         "--every-frame "
         "--box -1,0.8,-1,1,1.5,1\n"
         "  neuvv paint info build/performer.nvv build/look.nvpaint\n"
         "  neuvv render build/performer.nvv -o build/turn.mp4 --paint build/look.nvpaint,build/logo.nvpaint:tint\n"
         "  neuvv stage new build/show.gltf\n"
         "  neuvv stage add build/show.gltf build/performer.nvv --name anna --turn 0,30,0 --scale 1,1.2,1\n"
         "  neuvv paint brush build/show.gltf build/anna.nvpaint --node anna --time 1.5 --camera camera --size "
         "1280x720 "
         "--line 600,380 680,380 --colour '#d02020' --follow run"});
}

}  // namespace neuvv::tools

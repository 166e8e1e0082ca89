// neuvv paint: layers of paint on a performer, made and changed by command.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/platform.h"
#include "edit/brush.h"
#include "edit/project.h"
#include "tools/commands.h"
#include "tools/paint_easel.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "voctree/nvpaint.h"

namespace neuvv::tools {

namespace {

// The performer on the device, as it is painted, to be picked on.
struct PickedScene {
    PickedScene(const Easel& easel, const CommonOptions& common)
        : device(common.device),
          field(render::upload_field(device, easel.tree, render::WeightPrecision::kHalf)),
          picker(device, field) {
        show(easel, easel.at);
    }
    void show(const Easel& easel, float frame) {
        const std::vector<render::PaintUse> paint = easel.shown();
        sigma = edit::densities(easel.canvas, frame, paint);
        picker.show(frame, paint);
    }
    gpu::Device device;
    render::Field field;
    render::Picker picker;
    std::vector<float> sigma;
};

// Those in the region.
std::vector<voctree::LeafEdit> held_in(std::vector<voctree::LeafEdit> edits, const edit::Canvas& canvas,
                                       const edit::Region& region) {
    std::erase_if(edits, [&](const voctree::LeafEdit& edit) { return !region(canvas.middles[edit.leaf]); });
    return edits;
}

// Through each frame's own surface: as if a projector stood there while the clip plays.
std::vector<voctree::LeafEdit> projected_on_every(Easel& easel, PickedScene& scene, const media::Image& image,
                                                  const stage::Camera& camera, const edit::EditFrames& frames) {
    std::vector<voctree::LeafEdit> all;
    const auto first = static_cast<uint32_t>(std::ceil(frames.first)), last = static_cast<uint32_t>(frames.last);
    if (first > last)
        throw InputError("--frames", fmt::format("{}:{}", frames.first, frames.last), "has no whole frame",
                         "--every-frame projects on whole ones");
    Progress progress("project", last - first + 1);
    for (uint32_t frame = first; frame <= last; frame++) {
        if (stop_requested()) throw RuntimeFailure("stopped before the end");
        scene.show(easel, static_cast<float>(frame));
        for (voctree::LeafEdit& edit : edit::project(scene.picker, easel.canvas, scene.sigma, image, camera)) {
            edit.first = edit.last = static_cast<float>(frame);
            all.push_back(edit);
        }
        progress.update(frame - first + 1);
    }
    return edit::through_between(std::move(all), frames.first, frames.last);
}

// With their frames.
std::vector<voctree::LeafEdit> projected(Easel& easel, const PaintOptions& options, const edit::EditFrames& frames,
                                         const CommonOptions& common) {
    catch_stop_signals();
    const media::Image image = media::read_png(options.image);
    const stage::Camera camera = camera_of(options, easel, {image.width, image.height});
    PickedScene scene(easel, common);
    std::vector<voctree::LeafEdit> edits =
        options.every_frame
            ? projected_on_every(easel, scene, image, camera, frames)
            : edit::at_frames(easel.canvas, edit::project(scene.picker, easel.canvas, scene.sigma, image, camera),
                              frames);
    for (voctree::LeafEdit& edit : edits) edit.alpha *= static_cast<float>(options.alpha);
    return held_in(std::move(edits), easel.canvas, region_of(options));
}

std::vector<voctree::LeafEdit> brushed(Easel& easel, const PaintOptions& options, const CommonOptions& common) {
    expect_change(options);
    const edit::Brush brush = brush_of(options);
    const std::vector<glm::dvec2> line = line_of(options);
    const stage::Camera camera = camera_of(options, easel, picture_size(options, easel));
    PickedScene scene(easel, common);
    return held_in(edit::stroke(easel.canvas, scene.sigma, brush, edit::touches_under(scene.picker, camera, line)),
                   easel.canvas, region_of(options));
}

// With their frames.
std::vector<voctree::LeafEdit> filled(const Easel& easel, const PaintOptions& options, const edit::EditFrames& frames) {
    const edit::Region region = region_of(options);
    // A density brings leaves to life, so it goes to all of them.
    const std::vector<uint32_t> leaves = options.density.value_or(0) > 0
                                             ? edit::all_leaves_in(easel.canvas, region)
                                             : edit::leaves_in(easel.canvas, region, frames.first, frames.last);
    const auto sigma = static_cast<float>(options.density.value_or(double{voctree::kKeepSigma}));
    std::vector<voctree::LeafEdit> edits;
    if (options.density && (options.hue || options.saturation))
        edits = edit::at_frames(easel.canvas, edit::set_density(leaves, sigma), frames);
    if (options.hue || options.saturation) {
        std::vector<voctree::LeafEdit> colours = edit::shift_colours(
            easel.canvas, leaves, frames.first, frames.last,
            {static_cast<float>(options.hue.value_or(0)), static_cast<float>(options.saturation.value_or(1))});
        for (voctree::LeafEdit& edit : colours) edit.alpha *= static_cast<float>(options.alpha);
        edits.insert(edits.end(), colours.begin(), colours.end());
        return edits;
    }
    edits = edit::fill_leaves(leaves, colour_of(options),
                              options.colour.empty() ? 0.0f : static_cast<float>(options.alpha));
    for (voctree::LeafEdit& edit : edits) edit.sigma = sigma;
    return edit::at_frames(easel.canvas, edits, frames);
}

// Where the layer lies on its stage.
nlohmann::ordered_json stage_json(const StagePlace& place) {
    const bool listed = place.layer < place.who().settings.paint.size();
    return {{"file", place.stage.file.path.string()},
            {"node", place.who().node},
            {"name", place.who().name},
            {"layer", listed ? nlohmann::ordered_json(place.layer) : nlohmann::ordered_json()},
            {"added", !place.change.empty()}};
}

void print_layer(const PaintOptions& options, const Easel& easel) {
    const voctree::EditLayer& layer = easel.layer;
    std::map<uint32_t, size_t> of_leaf;
    size_t colours = 0, densities_set = 0, erased = 0;
    for (const voctree::LeafEdit& edit : layer.edits) {
        of_leaf[edit.leaf]++;
        colours += edit.alpha > 0;
        densities_set += edit.sigma > 0;
        erased += edit.sigma == 0;
    }
    if (!options.json) {
        fmt::print("{}: {} edits of {} of {} leaves: {} colours, {} densities, {} erased\n", options.layer,
                   layer.edits.size(), of_leaf.size(), layer.field.leaf_count, colours, densities_set, erased);
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
    if (easel.place) json["stage"] = stage_json(*easel.place);
    fmt::print("{}", json_text(json));
}

// Saves, and says what there is now.
void finish(const PaintOptions& options, const Easel& easel) {
    easel.save(options);
    print_layer(options, easel);
    if (easel.place && !easel.place->change.empty() && !options.json)
        fmt::print("{}: {}\n", options.scene, easel.place->change);
}

// What a verb adds to the layer.
using Edits = std::function<std::vector<voctree::LeafEdit>(Easel&, const edit::EditFrames&)>;

void paint(const PaintOptions& options, const Edits& make) {
    prepare_output_file("layer", options.layer);
    Easel easel(options);
    const edit::EditFrames frames = frames_of(options, easel.at, easel.tree.frames);
    const std::vector<voctree::LeafEdit> edits = make(easel, frames);
    if (edits.empty()) {
        fmt::print(stderr, "no leaf is there: nothing is painted, and nothing written\n");
        easel.leave();
        print_layer(options, easel);
        return;
    }
    voctree::add_edits(easel.layer, edits);
    finish(options, easel);
}

void restore(const PaintOptions& options) {
    expect_region(options);
    Easel easel(options, Easel::Use::kRead);
    prepare_output_file("layer", options.layer);
    const edit::EditFrames frames = frames_of(options, easel.at, easel.tree.frames);
    voctree::remove_edits(easel.layer, edit::all_leaves_in(easel.canvas, region_of(options)), frames.first,
                          frames.last);
    finish(options, easel);
}

void add_project(CLI::App& paints, const std::shared_ptr<PaintOptions>& options, const CommonOptions& common) {
    CLI::App* verb = paints.add_subcommand("project", "A picture, from a camera, onto what the camera sees");
    add_scene_options(*verb, *options);
    verb->add_option("--image", options->image, "The PNG; where it is transparent, nothing is painted")->required();
    add_camera_options(*verb, *options);
    add_alpha_option(*verb, *options);
    add_region_options(*verb, *options);
    add_frame_options(*verb, *options);
    CLI::Option* follow = add_follow_option(*verb, *options);
    verb->add_flag("--every-frame", options->every_frame,
                   "Onto each of --frames as it is then, as a projector would: nothing is left bare when the performer "
                   "moves. On a stage it stands as at --time")
        ->excludes(follow);
    verb->callback([options, &common] {
        paint(*options,
              [&](Easel& easel, const edit::EditFrames& frames) { return projected(easel, *options, frames, common); });
    });
}

void add_brush(CLI::App& paints, const std::shared_ptr<PaintOptions>& options, const CommonOptions& common) {
    CLI::App* verb = paints.add_subcommand("brush", "A stroke of a round brush along the surface");
    add_scene_options(*verb, *options);
    add_brush_options(*verb, *options);
    verb->add_option("--colour,--color", options->colour, "'#rrggbb' or a name");
    add_density_option(*verb, *options);
    add_camera_options(*verb, *options);
    add_alpha_option(*verb, *options);
    add_region_options(*verb, *options);
    add_frame_options(*verb, *options);
    add_follow_option(*verb, *options);
    verb->callback([options, &common] {
        paint(*options, [&](Easel& easel, const edit::EditFrames& frames) {
            return edit::at_frames(easel.canvas, brushed(easel, *options, common), frames);
        });
    });
}

void fill(const PaintOptions& options) {
    expect_region(options);
    expect_change(options);
    paint(options, [&](Easel& easel, const edit::EditFrames& frames) { return filled(easel, options, frames); });
}

void add_region(CLI::App& paints, const std::shared_ptr<PaintOptions>& options) {
    CLI::App* verb = paints.add_subcommand("region", "All leaves of a region: a colour, another hue, a density");
    add_scene_options(*verb, *options);
    CLI::Option* colour = verb->add_option("--colour,--color", options->colour, "'#rrggbb' or a name");
    CLI::Option* follow = add_follow_option(*verb, *options);
    verb->add_option("--hue", options->hue, "Degrees that hues turn by, at each frame from what they are then")
        ->check(number_between(-360, 360))
        ->excludes(colour)
        ->excludes(follow);
    verb->add_option("--saturation", options->saturation, "What saturation is multiplied by")
        ->check(number_between(0, 100))
        ->excludes(colour)
        ->excludes(follow);
    add_alpha_option(*verb, *options);
    add_density_option(*verb, *options);
    add_region_options(*verb, *options);
    add_frame_options(*verb, *options);
    verb->callback([options] { fill(*options); });
}

void add_erase_and_restore(CLI::App& paints, const std::shared_ptr<PaintOptions>& options) {
    CLI::App* erase = paints.add_subcommand("erase", "All leaves of a region: no density");
    CLI::App* back = paints.add_subcommand("restore", "Takes the layer's edits of a region out, at --frames");
    for (CLI::App* verb : {erase, back}) {
        add_scene_options(*verb, *options);
        add_region_options(*verb, *options);
        add_frame_options(*verb, *options);
    }
    add_follow_option(*erase, *options);
    erase->callback([options] {
        options->density = 0;
        fill(*options);
    });
    back->callback([options] { restore(*options); });
}

void add_info(CLI::App& paints, const std::shared_ptr<PaintOptions>& options) {
    CLI::App* verb = paints.add_subcommand("info", "What the layer holds");
    add_scene_options(*verb, *options);
    verb->callback([options] { print_layer(*options, Easel(*options, Easel::Use::kRead)); });
}

}  // namespace

void add_paint(CLI::App& app, CommonOptions& common) {
    CLI::App* verb = app.add_subcommand("paint", "Paint a scene: a layer of edits beside it, which stays as it is");
    const auto options = std::make_shared<PaintOptions>();
    verb->require_subcommand(1);
    add_project(*verb, options, common);
    add_brush(*verb, options, common);
    add_region(*verb, options);
    add_erase_and_restore(*verb, options);
    add_info(*verb, options);
    verb->footer(
        std::string(
            "`neuvv render --paint` shows layers of a .nvv. On a stage the performer is painted where it stands at\n"
            "--time, as its layers show it then, whatever stands before it; a layer that is not in its list yet "
            "becomes\n"
            "the uppermost one there. Copies have lists of their own, but a file that is in several shows on all.\n") +
        kDeviceHelp + kExamplesHead +
        "  neuvv paint region build/performer.nvv build/look.nvpaint --box -1,0,-1,1,0.9,1 --hue 120\n"
        "  neuvv paint brush build/performer.nvv build/look.nvpaint --line 300,200 420,220 --colour '#d02020' "
        "--follow all\n"
        "  neuvv paint project build/performer.nvv build/logo.nvpaint --image tools/performer/starry.png --every-frame "
        "--box -1,0.8,-1,1,1.5,1\n"
        "  neuvv paint info build/performer.nvv build/look.nvpaint\n"
        "  neuvv render build/performer.nvv -o build/turn.mp4 --paint build/look.nvpaint,build/logo.nvpaint:tint\n"
        "  neuvv stage new build/show.gltf\n"
        "  neuvv stage add build/show.gltf build/performer.nvv --name anna --turn 0,30,0 --scale 1,1.2,1\n"
        "  neuvv paint brush build/show.gltf build/anna.nvpaint --node anna --time 1.5 --camera camera --size 1280x720 "
        "--line 600,380 680,380 --colour '#d02020' --follow run");
}

}  // namespace neuvv::tools

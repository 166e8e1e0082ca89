// neuvv paint: layers of paint on a performer, made and changed by command.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "edit/brush.h"
#include "edit/project.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "training/camera_path_file.h"
#include "voctree/nvpaint.h"
#include "voctree/nvv.h"

namespace neuvv {

namespace {

using Numbers = std::vector<double>;

struct PaintOptions {
    std::string scene, layer;
    // When
    std::string frames;
    double at = 0;
    std::string follow = "not";
    // From where
    std::string camera, image, size = "720x720";
    uint32_t key = 0;
    double orbit = 0;
    // Which leaves
    std::vector<std::string> boxes, spheres, within_boxes, within_spheres, without_boxes, without_spheres;
    // The brush
    std::vector<std::string> line;
    double radius = 0.03, hardness = 0.7;
    // What becomes of them
    std::string colour;
    double alpha = 1;
    std::optional<double> density, hue, saturation;
    bool every_frame = false, json = false;
};

// "1,2,3" of so many numbers.
Numbers parse_numbers(const std::string& option, const std::string& text, size_t count) {
    Numbers numbers;
    size_t begin = 0;
    for (bool sound = true; sound && begin <= text.size();) {
        const size_t end = std::min(text.find(',', begin), text.size());
        double number = 0;
        sound = CLI::detail::lexical_cast(text.substr(begin, end - begin), number) && std::isfinite(number);
        if (sound) numbers.push_back(number);
        begin = end + 1;
        if (!sound) numbers.clear();
    }
    if (numbers.size() != count)
        throw InputError(option, text, "is not what it must be",
                         fmt::format("write {} numbers, as in 1,2.5,...", count));
    return numbers;
}

Region box_of(const std::string& option, const std::string& text) {
    const Numbers n = parse_numbers(option, text, 6);
    return box_region({n[0], n[1], n[2]}, {n[3], n[4], n[5]});
}

Region sphere_of(const std::string& option, const std::string& text) {
    const Numbers n = parse_numbers(option, text, 4);
    return sphere_region({n[0], n[1], n[2]}, static_cast<float>(n[3]));
}

// Any of the boxes and spheres, where there are none everywhere; in all those to be within, in none of those without.
Region region_of(const PaintOptions& options) {
    const bool anywhere = options.boxes.empty() && options.spheres.empty();
    Region region = [anywhere](glm::vec3) { return anywhere; };
    for (const std::string& text : options.boxes) region = either(region, box_of("--box", text));
    for (const std::string& text : options.spheres) region = either(region, sphere_of("--sphere", text));
    for (const std::string& text : options.within_boxes) region = both(region, box_of("--within-box", text));
    for (const std::string& text : options.within_spheres) region = both(region, sphere_of("--within-sphere", text));
    for (const std::string& text : options.without_boxes) region = without(region, box_of("--without-box", text));
    for (const std::string& text : options.without_spheres)
        region = without(region, sphere_of("--without-sphere", text));
    return region;
}

EditFrames frames_of(const PaintOptions& options, uint32_t clip_frames) {
    EditFrames frames;
    frames.follow = options.follow == "all" ? Follow::kAll : options.follow == "run" ? Follow::kRun : Follow::kNot;
    const FrameRange range = parse_frame_range(options.frames, clip_frames);
    const bool instant = options.frames.empty() && frames.follow != Follow::kNot;
    frames.first = static_cast<float>(instant ? options.at : range.first);
    frames.last = static_cast<float>(instant ? options.at : range.last);
    return frames;
}

// The key of --camera, or the orbit's camera at an angle, in pictures of this size.
Camera camera_of(const PaintOptions& options, const VOctree& tree, PictureSize size) {
    const Playback still{{0, 0}, 25, 25};
    if (!options.camera.empty()) {
        const CameraPath path = read_camera_path(options.camera, 1);
        if (options.key >= path.keys.size())
            throw InputError(options.camera, fmt::format("frame {}", options.key), "is not there",
                             fmt::format("choose --key 0 to {}", path.keys.size() - 1));
        return camera_at(path, path.keys[options.key].time_s, size.width, size.height);
    }
    const auto box = occupied_box(tree);
    const glm::dvec3 middle = 0.5 * (box.first + box.second);
    Camera camera = orbit_path(box, still, size)[0].camera;
    const glm::dmat4 turned = glm::rotate(glm::dmat4(1), glm::radians(options.orbit), glm::dvec3(0, 1, 0));
    camera.world_from_camera = glm::translate(glm::dmat4(1), middle) * turned * glm::translate(glm::dmat4(1), -middle) *
                               camera.world_from_camera;
    return camera;
}

glm::vec3 colour_of(const std::string& text) {
    return glm::vec3(parse_colour("--colour", text));
}

// The scene and its layer, from their files.
struct Easel {
    explicit Easel(const PaintOptions& options) : tree(read_nvv(options.scene)), canvas(tree) {
        layer.field = painted_field(tree);
        if (std::filesystem::exists(options.layer)) layer = read_paint(options.layer, layer.field);
        if (!(options.at >= 0 && options.at <= tree.frames - 1.0))
            throw InputError("--at", fmt::format("{}", options.at), "is no frame of the clip",
                             fmt::format("choose 0 to {}", tree.frames - 1));
    }
    VOctree tree;
    Canvas canvas;
    EditLayer layer;
};

// The scene on the device, as the layer paints it, to be picked on.
struct PickedScene {
    PickedScene(const Easel& easel, const PaintOptions& options, const CommonOptions& common)
        : device(common.device),
          field(upload_field(device, easel.tree, WeightPrecision::kHalf)),
          picker(device, field) {
        show(easel, static_cast<float>(options.at));
    }
    void show(const Easel& easel, float frame) {
        sigma = densities(easel.canvas, frame, std::array{PaintUse{&easel.layer}});
        picker.show(frame, std::array{PaintUse{&easel.layer}});
    }
    Device device;
    Field field;
    Picker picker;
    std::vector<float> sigma;
};

// Those in the region.
std::vector<LeafEdit> held_in(std::vector<LeafEdit> edits, const Canvas& canvas, const Region& region) {
    std::erase_if(edits, [&](const LeafEdit& edit) { return !region(canvas.middles[edit.leaf]); });
    return edits;
}

// Through each frame's own surface: as if a projector stood there while the clip plays.
std::vector<LeafEdit> projected_on_every(Easel& easel, PickedScene& scene, const Image& image, const Camera& camera,
                                         const EditFrames& frames) {
    std::vector<LeafEdit> all;
    const auto first = static_cast<uint32_t>(std::ceil(frames.first)), last = static_cast<uint32_t>(frames.last);
    Progress progress("project", last - first + 1);
    for (uint32_t frame = first; frame <= last; frame++) {
        if (stop_requested()) throw RuntimeFailure("stopped before the end");
        const auto at = static_cast<float>(frame);
        scene.show(easel, at);
        const std::vector<LeafEdit> edits = project(scene.picker, easel.canvas, scene.sigma, image, camera);
        // Half a frame to both sides, where slow motion shows more of this frame than of others.
        const EditFrames around{std::max(at - 0.5f, frames.first),
                                std::min(std::nextafter(at + 0.5f, 0.0f), frames.last)};
        const std::vector<LeafEdit> held = at_frames(easel.canvas, edits, around);
        all.insert(all.end(), held.begin(), held.end());
        progress.update(frame - first + 1);
    }
    return all;
}

// With their frames.
std::vector<LeafEdit> projected(Easel& easel, const PaintOptions& options, const EditFrames& frames,
                                const CommonOptions& common) {
    catch_stop_signals();
    const Image image = read_png(options.image);
    const Camera camera = camera_of(options, easel.tree, {image.width, image.height});
    PickedScene scene(easel, options, common);
    std::vector<LeafEdit> edits =
        options.every_frame
            ? projected_on_every(easel, scene, image, camera, frames)
            : at_frames(easel.canvas, project(scene.picker, easel.canvas, scene.sigma, image, camera), frames);
    for (LeafEdit& edit : edits) edit.alpha *= static_cast<float>(options.alpha);
    return held_in(std::move(edits), easel.canvas, region_of(options));
}

std::vector<LeafEdit> brushed(Easel& easel, const PaintOptions& options, const CommonOptions& common) {
    std::vector<glm::dvec2> pixels;
    for (const std::string& text : options.line) {
        const Numbers at = parse_numbers("--line", text, 2);
        pixels.emplace_back(at[0], at[1]);
    }
    const Brush brush{static_cast<float>(options.radius), static_cast<float>(options.hardness),
                      colour_of(options.colour.empty() ? "black" : options.colour),
                      options.colour.empty() ? 0 : static_cast<float>(options.alpha),
                      static_cast<float>(options.density.value_or(double{kKeepSigma}))};
    PickedScene scene(easel, options, common);
    const Camera camera = camera_of(options, easel.tree, parse_size(options.size));
    return held_in(stroke(easel.canvas, scene.sigma, brush, points_under(scene.picker, camera, pixels)), easel.canvas,
                   region_of(options));
}

std::vector<LeafEdit> filled(const Easel& easel, const PaintOptions& options, const EditFrames& frames) {
    const Region region = region_of(options);
    // A density brings leaves to life, so it goes to all of them.
    const std::vector<uint32_t> leaves = options.density.value_or(0) > 0
                                             ? all_leaves_in(easel.canvas, region)
                                             : leaves_in(easel.canvas, region, frames.first, frames.last);
    std::vector<LeafEdit> edits;
    if (options.hue || options.saturation)
        edits = shift_colours(
            easel.tree, leaves, static_cast<float>(options.at),
            {static_cast<float>(options.hue.value_or(0)), static_cast<float>(options.saturation.value_or(1))});
    else
        edits = fill_leaves(leaves, colour_of(options.colour.empty() ? "black" : options.colour),
                            options.colour.empty() ? 0.0f : 1.0f);
    for (LeafEdit& edit : edits) {
        edit.alpha *= static_cast<float>(options.alpha);
        edit.sigma = static_cast<float>(options.density.value_or(double{kKeepSigma}));
    }
    return edits;
}

void print_layer(const PaintOptions& options, const EditLayer& layer) {
    std::map<uint32_t, size_t> of_leaf;
    size_t colours = 0, densities_set = 0, erased = 0;
    for (const LeafEdit& edit : layer.edits) {
        of_leaf[edit.leaf]++;
        colours += edit.alpha > 0;
        densities_set += edit.sigma > 0;
        erased += edit.sigma == 0;
    }
    if (options.json)
        fmt::print("{}", json_text({{"file", options.layer},
                                    {"edits", layer.edits.size()},
                                    {"leaves", of_leaf.size()},
                                    {"colours", colours},
                                    {"densities", densities_set},
                                    {"erased", erased},
                                    {"field_leaves", layer.field.leaf_count},
                                    {"frames", layer.field.frames}}));
    else
        fmt::print("{}: {} edits of {} of {} leaves: {} colours, {} densities, {} erased\n", options.layer,
                   layer.edits.size(), of_leaf.size(), layer.field.leaf_count, colours, densities_set, erased);
}

// What a verb adds to the layer.
using Edits = std::function<std::vector<LeafEdit>(Easel&, const EditFrames&)>;

void paint(const PaintOptions& options, const Edits& make) {
    prepare_output_file("layer", options.layer);
    Easel easel(options);
    const EditFrames frames = frames_of(options, easel.tree.frames);
    const std::vector<LeafEdit> edits = make(easel, frames);
    if (edits.empty()) fmt::print(stderr, "no leaf is there: the layer stays as it is\n");
    add_edits(easel.layer, edits);
    write_paint(options.layer, easel.layer);
    print_layer(options, easel.layer);
}

void expect_region(const PaintOptions& options) {
    if (options.boxes.empty() && options.spheres.empty())
        throw InputError("neuvv paint", "", "no leaves are chosen", "give --box X0,Y0,Z0,X1,Y1,Z1 or --sphere X,Y,Z,R");
}

void restore(const PaintOptions& options) {
    expect_region(options);
    prepare_output_file("layer", options.layer);
    Easel easel(options);
    const EditFrames frames = frames_of(options, easel.tree.frames);
    remove_edits(easel.layer, all_leaves_in(easel.canvas, region_of(options)), frames.first, frames.last);
    write_paint(options.layer, easel.layer);
    print_layer(options, easel.layer);
}

void add_frame_options(CLI::App& verb, PaintOptions& options) {
    verb.add_option("--frames", options.frames, "FIRST:LAST frame at which it holds (default: the whole clip)");
    verb.add_option("--at", options.at, "The frame that is looked at")->capture_default_str();
    verb.add_option("--follow", options.follow,
                    "not: at --frames, whatever leaves show then; run: as long as a leaf stays opaque around --at (or "
                    "--frames); all: whenever it is opaque")
        ->check(CLI::IsMember({"not", "run", "all"}))
        ->capture_default_str();
}

void add_camera_options(CLI::App& verb, PaintOptions& options) {
    CLI::Option* camera =
        verb.add_option("--camera", options.camera, "A camera path or transforms.json, of which --key is the camera");
    verb.add_option("--key", options.key, "Which of its frames, from 0")->needs(camera)->capture_default_str();
    verb.add_option("--orbit", options.orbit, "In place of it, degrees around the scene: 0 is the front, +Z")
        ->excludes(camera)
        ->capture_default_str();
}

void add_region_options(CLI::App& verb, PaintOptions& options) {
    verb.add_option("--box", options.boxes, "X0,Y0,Z0,X1,Y1,Z1 in the scene's metres; any of several");
    verb.add_option("--sphere", options.spheres, "X,Y,Z,RADIUS; any of several");
    verb.add_option("--within-box", options.within_boxes, "Only what lies in this box, too");
    verb.add_option("--within-sphere", options.within_spheres, "Only what lies in this sphere, too");
    verb.add_option("--without-box", options.without_boxes, "But for what lies in this box");
    verb.add_option("--without-sphere", options.without_spheres, "But for what lies in this sphere");
}

CLI::Option* add_alpha_option(CLI::App& verb, PaintOptions& options) {
    return verb.add_option("--alpha", options.alpha, "How much of the colour")
        ->check(number_between(0, 1))
        ->capture_default_str();
}

CLI::Option* add_density_option(CLI::App& verb, PaintOptions& options) {
    return verb.add_option("--density", options.density, "1/m that leaves get; 0 erases")
        ->check(number_between(0, double{kMaxPaintSigma}));
}

void add_brush_options(CLI::App& verb, PaintOptions& options) {
    verb.add_option("--line", options.line, "X,Y X,Y ...: the pixels that the stroke goes along")->required();
    verb.add_option("--size", options.size, "WIDTHxHEIGHT of the picture that they lie in")->capture_default_str();
    verb.add_option("--radius", options.radius, "Metres")->check(number_between(1e-6, 1e6))->capture_default_str();
    verb.add_option("--hardness", options.hardness, "The part of the radius that is painted whole")
        ->check(number_between(0, 1))
        ->capture_default_str();
}

}  // namespace

void add_stage_paint(CLI::App& app, CommonOptions& common) {
    CLI::App* verb = app.add_subcommand("paint", "Paint a scene: a layer of edits beside it, which stays as it is");
    const auto options = std::make_shared<PaintOptions>();
    verb->add_option("scene", options->scene, "The .nvv file")->required();
    verb->add_option("layer", options->layer, "The .nvpaint to add to; made where there is none")->required();
    verb->add_flag("--json", options->json, "Print JSON: edits, leaves, colours, densities, erased");
    verb->require_subcommand(1);
    verb->fallthrough();

    CLI::App* image = verb->add_subcommand("project", "A picture, from a camera, onto what the camera sees");
    image->add_option("--image", options->image, "The PNG; where it is transparent, nothing is painted")->required();
    CLI::App* brush = verb->add_subcommand("brush", "A stroke of a round brush along the surface");
    add_brush_options(*brush, *options);
    brush->add_option("--colour", options->colour, "'#rrggbb' or a name");
    add_density_option(*brush, *options);
    for (CLI::App* one : {image, brush}) {
        add_camera_options(*one, *options);
        add_alpha_option(*one, *options);
    }
    CLI::App* region = verb->add_subcommand("region", "All leaves of a region: a colour, another hue, a density");
    CLI::Option* colour = region->add_option("--colour", options->colour, "'#rrggbb' or a name");
    region->add_option("--hue", options->hue, "Degrees that hues turn by, from what they are at --at")
        ->excludes(colour);
    region->add_option("--saturation", options->saturation, "What saturation is multiplied by")
        ->check(number_between(0, 100))
        ->excludes(colour);
    add_alpha_option(*region, *options);
    add_density_option(*region, *options);
    CLI::App* erase = verb->add_subcommand("erase", "All leaves of a region: no density");
    CLI::App* back = verb->add_subcommand("restore", "Takes the layer's edits of a region out, at --frames");
    image->add_flag(
        "--every-frame", options->every_frame,
        "Onto each of --frames as it is then, as a projector would: nothing is left bare when the performer "
        "moves");
    for (CLI::App* one : {image, brush, region, erase, back}) add_region_options(*one, *options);
    for (CLI::App* one : {image, brush, region, erase, back}) add_frame_options(*one, *options);
    CLI::App* info = verb->add_subcommand("info", "What the layer holds");

    image->callback([options, &common] {
        paint(*options,
              [&](Easel& easel, const EditFrames& frames) { return projected(easel, *options, frames, common); });
    });
    brush->callback([options, &common] {
        paint(*options, [&](Easel& easel, const EditFrames& frames) {
            return at_frames(easel.canvas, brushed(easel, *options, common), frames);
        });
    });
    const auto fill = [options] {
        expect_region(*options);
        paint(*options, [&](Easel& easel, const EditFrames& frames) {
            return at_frames(easel.canvas, filled(easel, *options, frames), frames);
        });
    };
    region->callback(fill);
    erase->callback([options, fill] {
        options->density = 0;
        fill();
    });
    back->callback([options] { restore(*options); });
    info->callback([options] {
        const VOctree tree = read_nvv(options->scene);
        print_layer(*options, read_paint(options->layer, painted_field(tree)));
    });
    verb->footer(
        std::string("`neuvv render --paint` shows layers.\n") + kDeviceHelp + kExamplesHead +
        "  neuvv paint build/performer.nvv build/look.nvpaint region --box -1,0,-1,1,0.9,1 --hue 120\n"
        "  neuvv paint build/performer.nvv build/look.nvpaint brush --line 300,200 420,220 --colour '#d02020' "
        "--follow all\n"
        "  neuvv paint build/performer.nvv build/logo.nvpaint project --image tools/performer/starry.png --every-frame "
        "--box -1,0.8,-1,1,1.5,1\n"
        "  neuvv paint build/performer.nvv build/look.nvpaint info\n"
        "  neuvv render build/performer.nvv -o build/turn.mp4 --paint build/look.nvpaint,build/logo.nvpaint:tint");
}

}  // namespace neuvv

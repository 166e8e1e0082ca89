#include "tools/paint/paint_options.h"

#include "base/error.h"
#include "stage/stage_settings.h"
#include "tools/commands.h"

namespace neuvv::tools {

namespace {

edit::Region box_of(const std::string& option, const std::string& text) {
    const std::vector<double> n = parse_numbers(option, text, 6, "write X0,Y0,Z0,X1,Y1,Z1");
    const glm::vec3 a(n[0], n[1], n[2]), b(n[3], n[4], n[5]);
    return edit::box_region(glm::min(a, b), glm::max(a, b));
}

edit::Region sphere_of(const std::string& option, const std::string& text) {
    const std::vector<double> n = parse_numbers(option, text, 4, "write X,Y,Z,RADIUS");
    if (!(n[3] > 0)) throw InputError(option, text, "has no radius above 0", "write X,Y,Z,RADIUS in metres");
    return edit::sphere_region({n[0], n[1], n[2]}, static_cast<float>(n[3]));
}

}  // namespace

void add_scene_options(Command paint, PaintOptions& options) {
    paint.add_option("scene", options.scene, "The .nvv file, or a stage (.gltf, .glb) that a performer stands on")
        .required();
    paint
        .add_option("layer", options.layer,
                    "The .nvpaint to add to, of a clip in segments a folder; made where there is none")
        .required();
    paint.add_option("--node", options.node, "Of a stage: the performer, by name or index; not needed where it is one");
    paint.add_option("--time", options.time_s, "Of a stage: the time at which it is seen, seconds (default: 0)")
        .number_between(-stage::kMaxStageSeconds, stage::kMaxStageSeconds);
    paint.add_flag("--json", options.json, "Print JSON: edits, leaves, colours, densities, erased; the stage's layer");
}

void add_frame_options(Command verb, PaintOptions& options) {
    verb.add_option("--frames", options.frames,
                    "FIRST:LAST frame of the clip at which the edits hold (default: all of it)");
    verb.add_option("--at", options.at,
                    "The frame that is seen (default: 0; on a stage, the one that shows at --time)");
}

Option add_follow_option(Command verb, PaintOptions& options) {
    static constexpr const char* kNames[] = {"not", "run", "all"};  // by Follow
    return add_choice(
        verb, "--follow", options.follow, kNames,
        "not: at --frames, whatever leaves show then; run: as long as a leaf stays opaque around --at (or "
        "--frames); all: whenever it is opaque (default: not)");
}

void add_camera_options(Command verb, PaintOptions& options) {
    Option camera = verb.add_option("--camera", options.camera,
                                    "A camera path or transforms.json, of which --key is the camera; or the name "
                                    "of a stage's camera (default there: its first)");
    verb.add_option("--key", options.key, "Which of its frames, from 0").needs(camera);
    verb.add_option("--orbit", options.orbit_deg, "In place of it, degrees around the scene: 0 is the front, +Z")
        .number_between(-1e6, 1e6)
        .excludes(camera);
}

void add_region_options(Command verb, PaintOptions& options) {
    verb.add_option("--box", options.boxes,
                    "X0,Y0,Z0,X1,Y1,Z1 in the performer's own metres, wherever it stands; any of several");
    verb.add_option("--sphere", options.spheres, "X,Y,Z,RADIUS in the same metres; any of several");
    verb.add_option("--within-box", options.within_boxes, "Only what lies in this box, too");
    verb.add_option("--within-sphere", options.within_spheres, "Only what lies in this sphere, too");
    verb.add_option("--without-box", options.without_boxes, "But for what lies in this box");
    verb.add_option("--without-sphere", options.without_spheres, "But for what lies in this sphere");
}

void add_alpha_option(Command verb, PaintOptions& options) {
    verb.add_option("--alpha", options.alpha, "How much of the colour").number_between(0, 1).show_default();
}

void add_density_option(Command verb, PaintOptions& options) {
    verb.add_option("--density", options.density, "1/m that leaves get; 0 erases")
        .number_between(0, double{kMaxPaintSigma});
}

void add_brush_options(Command verb, PaintOptions& options) {
    verb.add_option("--line", options.line, "X,Y X,Y ...: the pixels that the stroke goes along").required();
    verb.add_option("--size", options.size,
                    "WIDTHxHEIGHT of the image that they lie in (default: that of `neuvv render`: of the path of "
                    "--camera, else 720x720, of a stage 1280x720)");
    verb.add_option("--radius", options.radius_m, "In the performer's own metres, wherever it stands")
        .number_between(1e-6, 1e6)
        .show_default();
    verb.add_option("--hardness", options.hardness, "The part of the radius that is painted whole")
        .number_between(0, 1)
        .show_default();
}

edit::Region region_of(const PaintOptions& options) {
    const bool anywhere = options.boxes.empty() && options.spheres.empty();
    edit::Region region = [anywhere](glm::vec3) { return anywhere; };
    for (const std::string& text : options.boxes) region = edit::either(region, box_of("--box", text));
    for (const std::string& text : options.spheres) region = edit::either(region, sphere_of("--sphere", text));
    for (const std::string& text : options.within_boxes) region = edit::both(region, box_of("--within-box", text));
    for (const std::string& text : options.within_spheres)
        region = edit::both(region, sphere_of("--within-sphere", text));
    for (const std::string& text : options.without_boxes) region = edit::without(region, box_of("--without-box", text));
    for (const std::string& text : options.without_spheres)
        region = edit::without(region, sphere_of("--without-sphere", text));
    return region;
}

void expect_region(const PaintOptions& options) {
    if (options.boxes.empty() && options.spheres.empty())
        throw InputError("neuvv paint", "", "no leaves are selected",
                         "give --box X0,Y0,Z0,X1,Y1,Z1 or --sphere X,Y,Z,R");
}

void expect_change(const PaintOptions& options) {
    if (options.colour.empty() && !options.density && !options.hue && !options.saturation)
        throw InputError("neuvv paint", "", "says nothing of what the leaves become",
                         "give --colour '#d02020', --density, or for a region --hue or --saturation");
}

edit::EditFrames frames_of(const PaintOptions& options, float at, uint32_t clip_frames) {
    edit::EditFrames frames;
    frames.follow = options.follow.value_or(edit::Follow::kNot);
    const FrameRange range = parse_frame_range(options.frames, clip_frames);
    const bool at_alone = options.frames.empty() && frames.follow != edit::Follow::kNot;
    frames.first = at_alone ? at : static_cast<float>(range.first);
    frames.last = at_alone ? at : static_cast<float>(range.last);
    return frames;
}

editor::PaintOperation operation_of(const PaintOptions& options, const edit::EditFrames& frames) {
    const bool shifts = options.hue || options.saturation;
    editor::PaintOperation operation;
    operation.kind = shifts ? editor::PaintOperation::Kind::kShift : editor::PaintOperation::Kind::kColour;
    operation.colour = colour_of(options);
    operation.opacity = shifts || !options.colour.empty() ? static_cast<float>(options.alpha) : 0;
    operation.shift = {static_cast<float>(options.hue.value_or(0)), static_cast<float>(options.saturation.value_or(1))};
    operation.sigma = static_cast<float>(options.density.value_or(double{voctree::kKeepSigma}));
    operation.frames = frames;
    return operation;
}

editor::PaintArea area_of(const PaintOptions& options) {
    editor::PaintArea area;
    area.within = region_of(options);
    area.radius_m = static_cast<float>(options.radius_m);
    area.hardness = static_cast<float>(options.hardness);
    return area;
}

std::vector<glm::dvec2> line_of(const PaintOptions& options) {
    std::vector<glm::dvec2> pixels;
    for (const std::string& text : options.line) {
        const std::vector<double> at = parse_numbers("--line", text, 2, "write X,Y X,Y ...");
        pixels.emplace_back(at[0], at[1]);
    }
    return pixels;
}

glm::vec3 colour_of(const PaintOptions& options) {
    const glm::vec4 colour = parse_colour("--colour", options.colour.empty() ? "black" : options.colour);
    if (colour.a < 1)
        throw InputError("--colour", options.colour, "is no colour", "to erase, choose `neuvv paint erase`");
    return glm::vec3(colour);
}

}  // namespace neuvv::tools

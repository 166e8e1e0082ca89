// neuvv skeleton: where a performer's joints are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/platform.h"
#include "media/image_sink.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/video/triangulate.h"
#include "render/frame/frame_renderer.h"
#include "render/volume/slices/field.h"
#include "tools/commands.h"
#include "tools/image_drawing.h"
#include "tools/motion/skeleton_verbs.h"
#include "tools/options.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "tools/unfinished_folder.h"
#include "tools/view_path.h"
#include "training/capture/performer_views.h"
#include "voctree/files/clip.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::tools {

namespace {

constexpr const char* kSkeletonFooter = R"(
Examples, for a clip that `neuvv train` made:

  neuvv skeleton views work/performer.nvv -o work/views
  (run any 2D pose detector on work/views/images; its JSON goes to work/views/key_points)
  neuvv skeleton extract work/views -o work/performer.skeleton.glb
  neuvv skeleton show work/performer.nvv -o work/skeleton.mp4

Or, from a motion capture of the same performance in the same space:

  neuvv skeleton import work/take.bvh -o work/performer.skeleton.glb

For programs that animate by BVH:

  neuvv skeleton export work/performer.skeleton.glb -o work/performer.bvh

What somebody who performs along does otherwise:

  neuvv skeleton compare work/performer.skeleton.glb work/take.bvh --html work/report.html

A skeleton that lies beside CLIP.nvv as CLIP.skeleton.glb belongs to it. It is a glTF file that other programs open;
engine/motion/README.md describes it and the joints.)";

struct ViewsOptions {
    std::string clip, folder, size = "512x512";
    training::ViewSettings settings;
};

void run_views(ViewsOptions& options, const CommonOptions& common) {
    const media::ImageSize size = parse_size(options.size);
    options.settings.width = size.width;
    options.settings.height = size.height;
    const UnfinishedFolder unfinished(options.folder);
    const voctree::VOctree clip = voctree::read_clip(options.clip);
    catch_stop_signals();
    const gpu::Device device(common.device);
    Progress progress("views");
    const bool complete = training::render_performer_views(device, clip, unfinished.path(), options.settings,
                                                           [&](uint64_t done, uint64_t total) {
                                                               progress.set_total(total);
                                                               progress.update(done, "images");
                                                               return done == total || !stop_requested();
                                                           });
    progress.finish();
    if (!complete) throw RuntimeFailure("stopped before the end; nothing was written");
    unfinished.finish();
    tell("{0}: {1} views of {2} frames; write a detector's key points of {0}/images into {0}/key_points\n",
         options.folder, options.settings.views, clip.frames);
}

struct ImportOptions {
    std::string input, output, up, unit;
    motion::SkeletonReading reading;
};

constexpr std::pair<const char*, double> kUnits[] = {
    {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};

void run_import(ImportOptions& options) {
    prepare_result("--output", options.output, {".glb"});
    const auto axis = std::ranges::find(motion::kAxisNames, options.up);
    if (axis != motion::kAxisNames.end())
        options.reading.up = static_cast<motion::Axis>(axis - motion::kAxisNames.begin());
    for (const auto& [name, metres] : kUnits)
        if (options.unit == name) options.reading.unit_m = metres;
    const motion::SkeletonClip clip = read_motion(options.input, options.reading);
    motion::write_skeleton(options.output, clip);
    size_t measured = 0;
    for (const motion::JointSample& sample : clip.frames[0]) measured += sample.measured;
    tell("{}: {} frames at {:.6g} a second, a body of {:.2f} m; {} of {} joints are measured\n", options.output,
         clip.frames.size(), clip.fps, motion::body_height(motion::bone_lengths(clip)), measured, motion::kJoints);
}

struct BvhOptions {
    std::string input, output, animation, unit = "m";
};

void run_export(const BvhOptions& options) {
    if (std::filesystem::path(options.output).extension() != ".bvh")
        throw InputError("--output", options.output, "does not end with .bvh",
                         "name it so; a .skeleton.glb, which `neuvv skeleton import` writes, is animated glTF itself");
    prepare_result("--output", options.output);
    const motion::SkeletonClip clip = read_motion(options.input, {.animation = options.animation});
    motion::write_bvh(options.output, clip, options.unit == "cm" ? 100 : 1);
    tell("{}: {} frames at {:.6g} a second, in {}\n", options.output, clip.frames.size(), clip.fps,
         options.unit == "cm" ? "centimetres" : "metres");
}

struct ShowOptions {
    std::string clip, skeleton, output, frames, size = "640x640";
};

constexpr Colour kMiddle = {240, 240, 240}, kRight = {255, 140, 40}, kLeft = {60, 170, 255}, kGuessed = {130, 130, 130};

Colour colour_of(size_t joint, const motion::JointSample& sample) {
    if (!sample.measured) return kGuessed;
    const std::string name = motion::info_of(motion::joint_at(joint)).name;
    return name.starts_with("left") ? kLeft : name.starts_with("right") ? kRight : kMiddle;
}

// Bones over the image, with a square at each joint.
void draw_skeleton(media::Image& image, const stage::Camera& camera, const motion::Pose& pose) {
    const int width = std::max(2, static_cast<int>(image.height / 200));
    for (size_t j = 0; j < motion::kJoints; ++j) {
        const motion::JointSample& parent = motion::at(pose, motion::info_of(motion::joint_at(j)).parent);
        if (!(pose[j].confidence > 0 && parent.confidence > 0)) continue;
        const auto from = motion::project(camera, parent.position), to = motion::project(camera, pose[j].position);
        if (!from || !to) continue;
        draw_line(image, *from, *to, colour_of(j, pose[j]), width);
        draw_line(image, *to, *to, colour_of(j, pose[j]), 3 * width);
    }
}

void run_show(const ShowOptions& options, const CommonOptions& common) {
    const media::ImageOutput output = media::parse_output(options.output);
    if (output.exr) throw InputError("--output", options.output, "is not for linear images", "write .mp4 or .png");
    const voctree::VOctree clip = voctree::read_clip(options.clip);
    const motion::SkeletonClip skeleton =
        read_motion(options.skeleton.empty() ? motion::skeleton_beside(options.clip).string() : options.skeleton);
    const media::ImageSize size = parse_size(options.size);
    const double fps = clip.fps > 0 ? static_cast<double>(clip.fps) : 25;
    const Playback playback{parse_frame_range(options.frames, clip.frames), fps, fps};
    std::vector<ViewStep> path = orbit_path(voctree::occupied_box(clip), playback, size);
    if (output.kind == media::ImageOutput::Kind::kImage) path.resize(1);
    prepare_images("--output", output, 0, static_cast<uint32_t>(path.size()));
    catch_stop_signals();
    const gpu::Device device(common.device);
    const render::Field field = render::upload_field(device, clip, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, {size.width, size.height, kDefaultSamples});
    render::FrameSettings settings;
    settings.width = size.width;
    settings.height = size.height;
    settings.samples = kDefaultSamples;
    settings.resolve.background = {0, 0, 0, 1};
    settings.mode = render::TraceMode::kPlay;
    media::ImageSink sink(output, size, fps, {}, false);
    Progress progress("show", path.size());
    for (uint32_t i = 0; i < path.size(); ++i) {
        if (stop_requested()) throw RuntimeFailure(options.output + ": stopped before the end");
        settings.instances[0].frame = static_cast<float>(path[i].frame);
        media::Image image = renderer.render(path[i].camera, settings);
        // A skeleton may have another rate than the clip.
        draw_skeleton(image, path[i].camera, motion::pose_at(skeleton, path[i].frame / fps * skeleton.fps));
        sink.add(i, std::move(image));
        progress.update(i + 1);
    }
    sink.finish(static_cast<uint32_t>(path.size()));
    progress.finish();
    tell("{}: left is blue, right is orange, estimated joints are grey\n", options.output);
}

void add_views(Command group, CommonOptions& common) {
    Command verb = group.add_verb("views", "Render a clip from all around, for a 2D detector");
    const auto options = std::make_shared<ViewsOptions>();
    verb.add_option("CLIP", options->clip, "the .nvv").required();
    verb.add_option("-o,--output", options->folder, "folder of the images and their cameras; created").required();
    verb.add_option("--views", options->settings.views, "cameras, in two rings").show_default();
    verb.add_option("--size", options->size, "of the images, WxH pixels").show_default();
    verb.footer(
        {"\nExamples:\n"
         "  neuvv skeleton views work/performer.nvv -o work/views\n"
         "  neuvv skeleton views work/performer.nvv -o work/views --views 16 --size 768x768"});
    verb.callback([options, &common] { run_views(*options, common); });
}

void add_import(Command group) {
    Command verb = group.add_verb("import", "Read the motion of another program");
    const auto options = std::make_shared<ImportOptions>();
    verb.add_option("FILE", options->input, "an animated humanoid .glb, .gltf, .vrm or .vrma, a .bvh or a .trc")
        .required();
    verb.add_option("-o,--output", options->output, "the skeleton, .skeleton.glb").required();
    verb.add_option("--animation", options->reading.animation, "of a glTF file, its name or index; default: the first");
    verb.add_option("--up", options->up, "the file's axis that is up; default: y in glTF, else as the body stands")
        .one_of({motion::kAxisNames.begin(), motion::kAxisNames.end()});
    Option unit = verb.add_option("--unit", options->unit,
                                  "of lengths in the file; default: what it says, of a BVH by the body's height")
                      .one_of({"m", "cm", "mm", "in", "ft"});
    verb.add_option("--height", options->reading.height_m, "of the body, metres: lengths are scaled to it")
        .number_between(0.1, 10)
        .excludes(unit);
    verb.footer(
        {"\nExamples (from the repository's root):\n"
         "  neuvv skeleton import tools/performer/performer.glb -o work/performer.skeleton.glb\n"
         "  neuvv skeleton import work/take.bvh --up z --height 1.24 -o work/take.skeleton.glb"});
    verb.callback([options] { run_import(*options); });
}

void add_export_bvh(Command group) {
    Command verb = group.add_verb("export", "Write a skeleton's motion for another program, as BVH");
    const auto options = std::make_shared<BvhOptions>();
    verb.add_option("FILE", options->input, "a .skeleton.glb, or what `neuvv skeleton import` reads").required();
    verb.add_option("-o,--output", options->output, "the .bvh").required();
    verb.add_option("--animation", options->animation, "of a glTF file, its name or index; default: the first");
    verb.add_option("--unit", options->unit, "of lengths in the file: m as in Blender, cm as in Maya and MotionBuilder")
        .one_of({"m", "cm"})
        .show_default();
    verb.footer(
        {"\nThe .skeleton.glb itself is glTF: an armature with its animation, which other programs open.\n"
         "\nExample:\n"
         "  neuvv skeleton export work/performer.skeleton.glb -o work/performer.bvh"});
    verb.callback([options] { run_export(*options); });
}

void add_show(Command group, CommonOptions& common) {
    Command verb = group.add_verb("show", "Draw a clip's skeleton over a turn around it");
    const auto options = std::make_shared<ShowOptions>();
    verb.add_option("CLIP", options->clip, "the .nvv").required();
    verb.add_option("-o,--output", options->output, ".mp4, .png, or numbered images as shot_%04d.png").required();
    verb.add_option("--skeleton", options->skeleton, "default: CLIP.skeleton.glb beside the clip");
    verb.add_option("--frames", options->frames, "of the clip, \"A:B\" or \"A\"; default: all");
    verb.add_option("--size", options->size, "of the images, WxH pixels").show_default();
    verb.footer(
        {"\nExamples:\n"
         "  neuvv skeleton show work/performer.nvv -o work/skeleton.mp4\n"
         "  neuvv skeleton show work/performer.nvv -o work/skeleton.png --frames 20"});
    verb.callback([options, &common] { run_show(*options, common); });
}

}  // namespace

motion::SkeletonClip read_motion(const std::string& file, const motion::SkeletonReading& reading) {
    motion::SkeletonClip clip = motion::read_skeleton(file, reading);
    for (const Note& note : clip.notes) say("{}\n", message_of(note));
    return clip;
}

void add_skeleton(Command app, CommonOptions& common) {
    Command group = app.add_verb("skeleton", "Find, import, export, show and compare where a performer's joints are");
    group.require_verb();
    group.footer({kSkeletonFooter});
    add_views(group, common);
    add_skeleton_extract(group);
    add_import(group);
    add_export_bvh(group);
    add_show(group, common);
    add_skeleton_compare(group);
    add_skeleton_follow(group);
}

}  // namespace neuvv::tools

// neuvv skeleton: where a performer's joints are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "media/image_sink.h"
#include "motion/extract.h"
#include "motion/skeleton_file.h"
#include "motion/triangulate.h"
#include "render/field.h"
#include "render/frame.h"
#include "tools/commands.h"
#include "tools/image_drawing.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/skeleton_verbs.h"
#include "tools/view_path.h"
#include "training/formats.h"
#include "training/performer_views.h"
#include "voctree/clip.h"
#include "voctree/occupied_box.h"

namespace neuvv::tools {

namespace {

constexpr const char* kSkeletonFooter = R"(
Examples, for a clip that `neuvv train` made:

  neuvv skeleton views build/performer.nvv -o build/views
  (run any 2D pose detector on build/views/images; its JSON goes to build/views/key_points)
  neuvv skeleton extract build/views -o build/performer.skeleton.glb
  neuvv skeleton show build/performer.nvv -o build/skeleton.mp4

Or, from a motion capture of the same performance in the same space:

  neuvv skeleton import build/take.bvh -o build/performer.skeleton.glb

What somebody who performs along does otherwise:

  neuvv skeleton compare build/performer.skeleton.glb build/take.bvh --html build/report.html

A skeleton that lies beside CLIP.nvv as CLIP.skeleton.glb belongs to it. It is a glTF file that other programs open;
engine/motion/README.md describes it and the joints.)";

constexpr const char* kExtractFooter = R"(
Key points are one JSON an image, {"people": [{"pose_keypoints_2d": [x, y, confidence, ...]}]}, of COCO-17, BODY_25,
HALPE-26 or MediaPipe-33: what OpenPose writes with `--image_dir DIR/images --write_json DIR/key_points`, and Pose2Sim
into a folder for each camera. DIR may also be a captured data set whose images have no lens distortion.

Examples:
  neuvv skeleton extract build/views -o build/performer.skeleton.glb
  neuvv skeleton extract build/views --key-points build/views/pose -o build/performer.skeleton.glb)";

struct ViewsOptions {
    std::string clip, folder, size = "512x512";
    training::ViewSettings settings;
};

void run_views(ViewsOptions& options, const CommonOptions& common) {
    const media::ImageSize size = parse_size(options.size);
    options.settings.width = size.width;
    options.settings.height = size.height;
    prepare_output_folder("--output", options.folder);
    const voctree::VOctree clip = voctree::read_clip(options.clip);
    catch_stop_signals();
    const gpu::Device device(common.device);
    Progress progress("views");
    const bool complete = training::render_performer_views(device, clip, options.folder, options.settings,
                                                           [&](uint64_t done, uint64_t total) {
                                                               progress.set_total(total);
                                                               progress.update(done, "images");
                                                               return done == total || !stop_requested();
                                                           });
    progress.finish();
    if (!complete)
        throw RuntimeFailure(fmt::format("stopped; {} has images but no cameras: run it again", options.folder));
    fmt::print("{0}: {1} views of {2} frames; write a detector's key points of {0}/images into {0}/key_points\n",
               options.folder, options.settings.views, clip.frames);
}

struct ExtractOptions {
    std::string folder, key_points, output;
    bool each_frame = false;
};

stage::Camera pinhole(const training::RigCamera& camera, const std::string& file) {
    const training::Lens& lens = camera.lens;
    if (lens.distorts())
        throw InputError(file, camera.name, "has a lens that distorts", "detect key points in undistorted images");
    return {camera.world_from_camera, lens.fx, lens.fy, lens.cx, lens.cy, lens.width, lens.height};
}

// The cameras of a data set's splits, its times, and the images whose key points are wanted.
std::vector<motion::WantedImage> wanted_images(const std::vector<training::Rig>& splits, motion::Detections& seen) {
    std::vector<double> times;
    for (const training::Rig& rig : splits)
        for (const training::Shot& shot : rig.shots) times.push_back(shot.time);
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    seen.frames = times.size();
    seen.fps = splits[0].fps > 0 ? splits[0].fps : 25;
    std::vector<motion::WantedImage> images;
    for (const training::Rig& rig : splits) {
        const size_t first_camera = seen.cameras.size();
        for (const training::RigCamera& camera : rig.cameras) seen.cameras.push_back(pinhole(camera, rig.file));
        for (const training::Shot& shot : rig.shots) {
            const auto frame = static_cast<size_t>(std::ranges::lower_bound(times, shot.time) - times.begin());
            const std::string image = shot.image.path.stem().string();
            // Images that this program wrote, c03_f012, name their cameras; other layouts name cameras themselves.
            const size_t mark = image.rfind("_f");
            const std::string camera =
                mark == std::string::npos ? rig.cameras[shot.camera].name : image.substr(0, mark);
            images.push_back({camera, image, first_camera + shot.camera, frame});
        }
    }
    return images;
}

// The training cameras, and those that a capture holds out, which see the performer as well.
std::vector<training::Rig> read_splits(const std::string& folder) {
    std::vector<training::Rig> splits = {training::read_rig(folder, training::Split::kTrain)};
    try {
        splits.push_back(training::read_rig(folder, training::Split::kTest));
    } catch (const InputError&) {  // not every data set has a test split
    }
    return splits;
}

void print_quality(const motion::Extraction& found, const motion::Detections& seen) {
    const motion::ExtractQuality& quality = found.quality;
    fmt::print("joint              seen off by     in frames\n");
    for (size_t j = 0; j < motion::kJoints; ++j)
        fmt::print("{:<18} {:7.2f} % {:12.0f} %{}\n", motion::info_of(motion::joint_at(j)).name, 100 * quality.error[j],
                   100 * quality.known[j], seen.lacking[j] ? "  (the detector lacks it)" : "");
    fmt::print(
        "a body of {:.2f} m; errors are shares of it. {} arms and legs were exchanged back, {:.1f} % of {} key points "
        "contradict the others\n",
        quality.height_m, quality.swapped,
        100.0 * static_cast<double>(quality.outliers) / static_cast<double>(std::max<size_t>(quality.key_points, 1)),
        quality.key_points);
    if (seen.images_with_others > 0)
        fmt::print("{} images show several people: the most confident one of each counted\n", seen.images_with_others);
}

void run_extract(const ExtractOptions& options) {
    prepare_output_file("--output", options.output);
    motion::Detections seen;
    const std::vector<motion::WantedImage> images = wanted_images(read_splits(options.folder), seen);
    std::filesystem::path folder = options.key_points;
    if (folder.empty()) folder = std::filesystem::path(options.folder) / "key_points";
    motion::read_detections(folder, images, seen);
    fmt::print(stderr, "{} frames from {} views\n", seen.frames, seen.cameras.size());
    const motion::Extraction found = motion::extract_skeleton(seen, {!options.each_frame});
    motion::write_skeleton(options.output, found.clip);
    print_quality(found, seen);
    fmt::print("wrote {}\n", options.output);
}

struct ImportOptions {
    std::string input, output, animation;
};

void run_import(const ImportOptions& options) {
    prepare_output_file("--output", options.output);
    const motion::SkeletonClip clip = motion::read_skeleton(options.input, options.animation);
    motion::write_skeleton(options.output, clip);
    size_t measured = 0;
    for (const motion::JointSample& sample : clip.frames[0]) measured += sample.measured;
    fmt::print("{}: {} frames at {:.6g} a second, a body of {:.2f} m; {} of {} joints are measured\n", options.output,
               clip.frames.size(), clip.fps, motion::body_height(motion::bone_lengths(clip)), measured,
               motion::kJoints);
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
    prepare_output_file("--output", output.path);
    const voctree::VOctree clip = voctree::read_clip(options.clip);
    const motion::SkeletonClip skeleton = motion::read_skeleton(
        options.skeleton.empty() ? motion::skeleton_beside(options.clip) : std::filesystem::path(options.skeleton));
    const media::ImageSize size = parse_size(options.size);
    const double fps = clip.fps > 0 ? static_cast<double>(clip.fps) : 25;
    const Playback playback{parse_frame_range(options.frames, clip.frames), fps, fps};
    std::vector<ViewStep> path = orbit_path(voctree::occupied_box(clip), playback, size);
    if (output.kind == media::ImageOutput::Kind::kImage) path.resize(1);
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
        sink.add(i, image);
        progress.update(i + 1);
    }
    sink.finish(static_cast<uint32_t>(path.size()));
    progress.finish();
    fmt::print("{}: left is blue, right is orange, estimated joints are grey\n", options.output);
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
         "  neuvv skeleton views build/performer.nvv -o build/views\n"
         "  neuvv skeleton views build/performer.nvv -o build/views --views 16 --size 768x768"});
    verb.callback([options, &common] { run_views(*options, common); });
}

void add_extract(Command group) {
    Command verb = group.add_verb("extract", "Find the joints from key points of many views");
    const auto options = std::make_shared<ExtractOptions>();
    verb.add_option("DIR", options->folder, "the folder of `neuvv skeleton views`").required();
    verb.add_option("-o,--output", options->output, "the skeleton, .skeleton.glb").required();
    verb.add_option("--key-points", options->key_points, "the detector's folder; default: DIR/key_points");
    verb.add_flag("--each-frame", options->each_frame, "triangulate each frame by itself, without the fit over time");
    verb.footer({kExtractFooter});
    verb.callback([options] { run_extract(*options); });
}

void add_import(Command group) {
    Command verb = group.add_verb("import", "Read the motion of another program");
    const auto options = std::make_shared<ImportOptions>();
    verb.add_option("FILE", options->input, "an animated humanoid .glb or .gltf, a .bvh or a .trc").required();
    verb.add_option("-o,--output", options->output, "the skeleton, .skeleton.glb").required();
    verb.add_option("--animation", options->animation, "of a glTF file, its name or index; default: the first");
    verb.footer(
        {"\nExample (from the repository's root):\n"
         "  neuvv skeleton import tools/performer/performer.glb -o build/performer.skeleton.glb"});
    verb.callback([options] { run_import(*options); });
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
         "  neuvv skeleton show build/performer.nvv -o build/skeleton.mp4\n"
         "  neuvv skeleton show build/performer.nvv -o build/skeleton.png --frames 20"});
    verb.callback([options, &common] { run_show(*options, common); });
}

}  // namespace

void add_skeleton(Command app, CommonOptions& common) {
    Command group = app.add_verb("skeleton", "Find, import, show and compare where a performer's joints are");
    group.require_verb();
    group.footer({kSkeletonFooter});
    add_views(group, common);
    add_extract(group);
    add_import(group);
    add_show(group, common);
    add_skeleton_compare(group);
    add_skeleton_follow(group);
}

}  // namespace neuvv::tools

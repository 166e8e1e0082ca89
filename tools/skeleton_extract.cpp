// neuvv skeleton extract: the joints of a performer, from key points of many views.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "base/output_path.h"
#include "motion/extract.h"
#include "motion/skeleton_file.h"
#include "tools/commands.h"
#include "tools/skeleton_verbs.h"
#include "training/formats.h"

namespace neuvv::tools {

namespace {

constexpr const char* kExtractFooter = R"(
Key points are one JSON an image, {"people": [{"pose_keypoints_2d": [x, y, confidence, ...]}]}, of COCO-17, BODY_25,
HALPE-26 or MediaPipe-33: what OpenPose writes with `--image_dir DIR/images --write_json DIR/key_points`, and Pose2Sim
into a folder for each camera. DIR may also be a captured data set whose images have no lens distortion.

Examples:
  neuvv skeleton extract build/views -o build/performer.skeleton.glb
  neuvv skeleton extract build/views --key-points build/views/pose -o build/performer.skeleton.glb)";

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

}  // namespace

void add_skeleton_extract(Command group) {
    Command verb = group.add_verb("extract", "Find the joints from key points of many views");
    const auto options = std::make_shared<ExtractOptions>();
    verb.add_option("DIR", options->folder, "the folder of `neuvv skeleton views`").required();
    verb.add_option("-o,--output", options->output, "the skeleton, .skeleton.glb").required();
    verb.add_option("--key-points", options->key_points, "the detector's folder; default: DIR/key_points");
    verb.add_flag("--each-frame", options->each_frame, "triangulate each frame by itself, without the fit over time");
    verb.footer({kExtractFooter});
    verb.callback([options] { run_extract(*options); });
}

}  // namespace neuvv::tools

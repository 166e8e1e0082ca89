// neuvv skeleton extract: the joints of a performer, from key points of many views.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "interchange/camera/lens.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/video/extract.h"
#include "motion/video/key_point_detector.h"
#include "tools/commands.h"
#include "tools/motion/skeleton_verbs.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "training/data/layouts/formats.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::tools {

namespace {

constexpr const char* kExtractFooter = R"(
Key points are one JSON an image, {"people": [{"pose_keypoints_2d": [x, y, confidence, ...]}]}: what OpenPose writes
with `--image_dir DIR/images --write_json DIR/key_points`, and Pose2Sim into a folder for each camera. MMPose's and
AlphaPose's JSON of an image, or of all, are read, too. The sets are COCO-17, BODY_25 and 25B, HALPE-26, 68 and 136,
COCO-133, BODY_135, MediaPipe-33 and OpenPose-18. Files belong to the images of their names or numbers: an image without a file
shows nobody. DIR may also be a captured data set; key points are those of its images, before lenses are corrected.

--model runs a detector here and writes such files: an ONNX network that takes an image of one person, as HRNet,
SimpleBaseline, ViTPose and RTMPose do (1×3×height×width, RGB), and gives heat maps (1×K×h×w) or SimCC's columns and
rows (1×K×w, 1×K×h). NeuVV comes with no network. A network is a program: use only those that you trust.

Examples:
  neuvv skeleton extract work/views -o work/performer.skeleton.glb
  neuvv skeleton extract work/views --model vitpose-b-coco.onnx -o work/performer.skeleton.glb
  neuvv skeleton extract work/views --key-points work/views/pose -o work/performer.skeleton.glb)";

struct ExtractOptions {
    std::string folder, key_points, set, model, output, pixels = "imagenet";
    bool each_frame = false;
};

stage::Camera pinhole(const training::RigCamera& camera) {
    const interchange::Lens& lens = camera.lens;
    return {camera.world_from_camera, lens.fx, lens.fy, lens.cx, lens.cy, lens.width, lens.height};
}

// Key points where pinhole cameras would show them. Those that no direction explains are left out.
void undistort_key_points(const std::vector<training::Rig>& splits, motion::Detections& seen) {
    size_t index = 0;
    for (const training::Rig& rig : splits)
        for (const training::RigCamera& camera : rig.cameras) {
            const interchange::Lens& lens = camera.lens;
            for (size_t f = 0; f < seen.frames && lens.distorts(); ++f)
                for (motion::KeyPoint& point : seen.in(f, index)) {
                    if (!(point.confidence > 0)) continue;
                    const std::optional<glm::dvec2> xy = interchange::direction_at(lens, point.pixel);
                    if (xy)
                        point.pixel = {lens.cx + lens.fx * xy->x, lens.cy + lens.fy * xy->y};
                    else
                        point.confidence = 0;
                }
            ++index;
        }
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
        for (const training::RigCamera& camera : rig.cameras) seen.cameras.push_back(pinhole(camera));
        for (const training::Shot& shot : rig.shots) {
            const auto frame = static_cast<size_t>(std::ranges::lower_bound(times, shot.time) - times.begin());
            std::string image = shot.image.path.stem().string();
            if (shot.image.video_frame >= 0) image += fmt::format("_{:06}", shot.image.video_frame);
            // Images that this program wrote, c03_f012, name their cameras; other layouts name cameras themselves.
            const size_t mark = image.rfind("_f");
            const std::string camera = mark == std::string::npos || shot.image.video_frame >= 0
                                           ? rig.cameras[shot.camera].name
                                           : image.substr(0, mark);
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
    tell("joint              seen off by     in frames\n");
    for (size_t j = 0; j < motion::kJoints; ++j)
        tell("{:<18} {:7.2f} % {:12.0f} %{}\n", motion::info_of(motion::joint_at(j)).name, 100 * quality.error[j],
             100 * quality.known[j], seen.lacking[j] ? "  (the detector lacks it)" : "");
    tell(
        "a body of {:.2f} m; errors are shares of it. {} arms and legs were exchanged back, {:.1f} % of {} key points "
        "contradict the others\n",
        quality.height_m, quality.swapped,
        100.0 * static_cast<double>(quality.outliers) / static_cast<double>(std::max<size_t>(quality.key_points, 1)),
        quality.key_points);
    if (const auto several = std::ranges::count_if(seen.people, [](const auto& people) { return people.size() > 1; }))
        tell("{} images show several people: the most confident one of each counted\n", several);
}

motion::PixelScale pixel_scale(const std::string& name) {
    return name == "imagenet" ? motion::PixelScale::kImageNet
           : name == "unit"   ? motion::PixelScale::kUnit
                              : motion::PixelScale::kBytes;
}

// The key points in every image of the splits, in the order of wanted_images. Throws RuntimeFailure where the user
// stops it.
std::vector<std::vector<motion::KeyPoint>> detect_in_images(motion::KeyPointDetector& detector,
                                                            const std::vector<training::Rig>& splits) {
    std::vector<const training::Shot*> shots;
    std::vector<const interchange::Lens*> lenses;
    for (const training::Rig& rig : splits)
        for (const training::Shot& shot : rig.shots) {
            shots.push_back(&shot);
            lenses.push_back(&rig.cameras[shot.camera].lens);
        }
    catch_stop_signals();
    training::ImageReader reader;
    std::vector<std::vector<motion::KeyPoint>> found;
    Progress progress("detect", shots.size());
    for (size_t i = 0; i < shots.size(); ++i) {
        if (stop_requested()) throw RuntimeFailure("stopped before the end; no key points were written");
        const media::Image image = reader.read(shots[i]->image);
        if (image.width != lenses[i]->width || image.height != lenses[i]->height)
            throw InputError(shots[i]->image.path.string(), "",
                             fmt::format("is {}×{} pixels, its camera {}×{}", image.width, image.height,
                                         lenses[i]->width, lenses[i]->height),
                             "give the images that the cameras were calibrated for");
        found.push_back(detector.detect(image));
        progress.update(i + 1, "images");
    }
    return found;
}

// Runs a network on all images, and writes what it finds into the folder once it has seen all of them.
void write_detections(const ExtractOptions& options, const std::vector<training::Rig>& splits,
                      std::span<const motion::WantedImage> images, const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error))
        throw InputError(folder.string(), "", "is there already, of another run or another detector",
                         "remove it, name another folder with --key-points, or leave out --model");
    const std::vector<std::filesystem::path> files = motion::key_point_files(folder, images);
    prepare_output_folder("--key-points", folder);
    motion::KeyPointDetector detector(options.model, pixel_scale(options.pixels));
    const std::vector<std::vector<motion::KeyPoint>> found = detect_in_images(detector, splits);
    for (size_t i = 0; i < files.size(); ++i) motion::write_person(files[i], found[i]);
    say("wrote {} key points of {} images into {}\n", detector.layout().name, files.size(), folder.string());
}

// DIR/key_points; of a project of Pose2Sim that has none, DIR/pose.
std::filesystem::path default_folder(const ExtractOptions& options) {
    const std::filesystem::path folder = options.folder;
    std::error_code ignored;
    const bool is_pose2sim = options.model.empty() && !std::filesystem::exists(folder / "key_points", ignored) &&
                             std::filesystem::is_directory(folder / "pose", ignored);
    return folder / (is_pose2sim ? "pose" : "key_points");
}

// The set that the user names; null: none.
const motion::KeyPointLayout* named_set(const ExtractOptions& options) {
    if (options.set.empty()) return nullptr;
    const motion::KeyPointLayout* layout = motion::find_key_point_layout(std::string_view(options.set));
    if (!layout)
        throw InputError("--set", options.set, "is no set of key points", "name one of " + motion::key_point_layouts());
    return layout;
}

void run_extract(const ExtractOptions& options) {
    prepare_result("--output", options.output, {".glb"});
    motion::Detections seen;
    const motion::KeyPointLayout* const set = named_set(options);
    const std::vector<training::Rig> splits = read_splits(options.folder);
    const std::vector<motion::WantedImage> images = wanted_images(splits, seen);
    std::filesystem::path folder = options.key_points;
    if (folder.empty()) folder = default_folder(options);
    if (!options.model.empty()) write_detections(options, splits, images, folder);
    motion::read_detections(folder, images, seen, set);
    for (const std::string& note : seen.notes) say("{}\n", note);
    undistort_key_points(splits, seen);
    say("{} frames from {} views\n", seen.frames, seen.cameras.size());
    const motion::Extraction found = motion::extract_skeleton(seen, {!options.each_frame});
    motion::write_skeleton(options.output, found.clip);
    print_quality(found, seen);
    tell("wrote {}\n", options.output);
}

}  // namespace

void add_skeleton_extract(Command group) {
    Command verb = group.add_verb("extract", "Find the joints from key points of many views");
    const auto options = std::make_shared<ExtractOptions>();
    verb.add_option("DIR", options->folder, "the folder of `neuvv skeleton views`").required();
    verb.add_option("-o,--output", options->output, "the skeleton, .skeleton.glb").required();
    verb.add_option("--key-points", options->key_points,
                    "the detector's folder; default: DIR/key_points, or DIR/pose of Pose2Sim");
    Option model = verb.add_option("--model", options->model,
                                   "a network, .onnx: find key points in the images with it and write them there");
    verb.add_option("--pixels", options->pixels,
                    "what the network takes: imagenet (colours less ImageNet's mean, by its deviation), unit (0 to 1), "
                    "bytes (0 to 255)")
        .one_of({"imagenet", "unit", "bytes"})
        .show_default()
        .needs(model);
    verb.add_option("--set", options->set,
                    "the detector's set of key points; default: by how many there are, and where");
    verb.add_flag("--each-frame", options->each_frame, "triangulate each frame by itself, without the fit over time");
    verb.footer({kExtractFooter});
    verb.callback([options] { run_extract(*options); });
}

}  // namespace neuvv::tools

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
#include "motion/video/people.h"
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
AlphaPose's JSON of an image, or of all, are read, too. Files belong to the images of their names or numbers: an image
without a file shows nobody. The sets are COCO-17, BODY_25 and 25B, HALPE-26, 68 and 136, COCO-133, BODY_135,
MediaPipe-33 and OpenPose-18. DIR may also be a captured data set, or a trial of Pose2Sim, whose session has the
calibration; key points are those of its images, before lenses are corrected.

Where images show several people, views of one agree on where the joints are; --person 2 is the one whom views show
second most.

--model runs a detector here and writes such files: an ONNX network that takes an image of one person, as HRNet,
SimpleBaseline, ViTPose and RTMPose do (1×3×height×width, RGB), and gives heat maps (1×K×h×w) or SimCC's columns and
rows (1×K×w, 1×K×h). NeuVV comes with no network. A network is a program: use only those that you trust.

Examples:
  neuvv skeleton extract work/views -o work/performer.skeleton.glb
  neuvv skeleton extract work/views --model vitpose-b-coco.onnx -o work/performer.skeleton.glb
  neuvv skeleton extract session/trial -o work/trial.skeleton.glb
  neuvv skeleton extract session/trial --person 2 -o work/second.skeleton.glb)";

struct ExtractOptions {
    std::string folder, key_points, set, model, output, pixels = "imagenet";
    size_t person = 1;
    bool each_frame = false;
};

stage::Camera pinhole(const training::RigCamera& camera) {
    const interchange::Lens& lens = camera.lens;
    return {camera.world_from_camera, lens.fx, lens.fy, lens.cx, lens.cy, lens.width, lens.height};
}

// Key points where a pinhole camera would show them. Those that no direction explains are left out.
void undistort(const interchange::Lens& lens, motion::KeyPoints& points) {
    if (!lens.distorts()) return;
    for (motion::KeyPoint& point : points) {
        if (!(point.confidence > 0)) continue;
        const std::optional<glm::dvec2> xy = interchange::direction_at(lens, point.pixel);
        if (xy)
            point.pixel = {lens.cx + lens.fx * xy->x, lens.cy + lens.fy * xy->y};
        else
            point.confidence = 0;
    }
}

void undistort_key_points(const training::Rig& rig, motion::Detections& seen) {
    for (size_t i = 0; i < seen.points.size(); ++i) {
        const interchange::Lens& lens = rig.cameras[i % rig.cameras.size()].lens;
        undistort(lens, seen.points[i]);
        for (motion::KeyPoints& person : seen.people[i]) undistort(lens, person);
    }
}

// The cameras of a data set, its times, and the images whose key points are wanted.
std::vector<motion::WantedImage> wanted_images(const training::Rig& rig, motion::Detections& seen) {
    std::vector<double> times;
    for (const training::Shot& shot : rig.shots) times.push_back(shot.time);
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    seen.frames = times.size();
    seen.fps = rig.fps > 0 ? rig.fps : 25;
    for (const training::RigCamera& camera : rig.cameras) seen.cameras.push_back(pinhole(camera));
    std::vector<motion::WantedImage> images;
    for (const training::Shot& shot : rig.shots) {
        const auto frame = static_cast<size_t>(std::ranges::lower_bound(times, shot.time) - times.begin());
        std::string image = shot.image.path.stem().string();
        if (shot.image.video_frame >= 0) image += fmt::format("_{:06}", shot.image.video_frame);
        // Images that this program wrote, c03_f012, name their cameras; other layouts name cameras themselves.
        const size_t mark = image.rfind("_f");
        const std::string camera = mark == std::string::npos || shot.image.video_frame >= 0
                                       ? rig.cameras[shot.camera].name
                                       : image.substr(0, mark);
        images.push_back({camera, image, shot.camera, frame});
    }
    return images;
}

// The performer's key points, of all people in the images.
void choose_person(const ExtractOptions& options, const std::filesystem::path& folder, motion::Detections& seen) {
    std::vector<motion::Person> people = motion::find_people(seen);
    if (people.empty())
        throw InputError(folder.string(), "", "no two views agree on anybody",
                         "look at the key points: are they of these images?");
    if (options.person > people.size())
        throw InputError("--person", std::to_string(options.person),
                         fmt::format("is not there: {} {} found", people.size(), people.size() > 1 ? "were" : "was"),
                         "leave it out for the one whom views show most");
    for (size_t i = 0; i < people.size() && people.size() > 1; ++i)
        say("person {}{}: around ({:.2f}, {:.2f}, {:.2f}) m, in {} frames by {:.1f} views\n", i + 1,
            i + 1 == options.person ? ", this one" : "", people[i].place.x, people[i].place.y, people[i].place.z,
            people[i].frames, static_cast<double>(people[i].views) / static_cast<double>(people[i].frames));
    seen.points = std::move(people[options.person - 1].points);
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
}

motion::PixelScale pixel_scale(const std::string& name) {
    return name == "imagenet" ? motion::PixelScale::kImageNet
           : name == "unit"   ? motion::PixelScale::kUnit
                              : motion::PixelScale::kBytes;
}

// The key points in every image, in the order of wanted_images. Throws RuntimeFailure where the user
// stops it.
std::vector<std::vector<motion::KeyPoint>> detect_in_images(motion::KeyPointDetector& detector,
                                                            const training::Rig& rig) {
    catch_stop_signals();
    training::ImageReader reader;
    std::vector<std::vector<motion::KeyPoint>> found;
    Progress progress("detect", rig.shots.size());
    for (const training::Shot& shot : rig.shots) {
        if (stop_requested()) throw RuntimeFailure("stopped before the end; no key points were written");
        const media::Image image = reader.read(shot.image);
        const interchange::Lens& lens = rig.cameras[shot.camera].lens;
        if (image.width != lens.width || image.height != lens.height)
            throw InputError(
                shot.image.path.string(), "",
                fmt::format("is {}×{} pixels, its camera {}×{}", image.width, image.height, lens.width, lens.height),
                "give the images that the cameras were calibrated for");
        found.push_back(detector.detect(image));
        progress.update(found.size(), "images");
    }
    return found;
}

// Runs a network on all images, and writes what it finds into the folder once it has seen all of them. Returns the set
// of its key points.
const motion::KeyPointLayout& write_detections(const ExtractOptions& options, const training::Rig& rig,
                                               std::span<const motion::WantedImage> images,
                                               const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error))
        throw InputError(folder.string(), "", "is there already, of another run or another detector",
                         "remove it, name another folder with --key-points, or leave out --model");
    const std::vector<std::filesystem::path> files = motion::key_point_files(folder, images);
    prepare_output_folder("--key-points", folder);
    motion::KeyPointDetector detector(options.model, pixel_scale(options.pixels));
    const std::vector<std::vector<motion::KeyPoint>> found = detect_in_images(detector, rig);
    for (size_t i = 0; i < files.size(); ++i) motion::write_person(files[i], found[i]);
    say("wrote {} key points of {} images into {}\n", detector.layout().name, files.size(), folder.string());
    return detector.layout();
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
    const motion::KeyPointLayout* set = named_set(options);
    const training::Rig rig = training::read_rig_of_points(options.folder);
    const std::vector<motion::WantedImage> images = wanted_images(rig, seen);
    std::filesystem::path folder = options.key_points;
    if (folder.empty()) folder = default_folder(options);
    if (!options.model.empty()) set = &write_detections(options, rig, images, folder);
    motion::read_detections(folder, images, seen, set);
    undistort_key_points(rig, seen);
    choose_person(options, folder, seen);
    for (const std::string& remark : rig.remarks) say("{}\n", remark);
    for (const std::string& note : seen.notes) say("{}\n", note);
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
    verb.add_option("--person", options->person, "whose joints, where images show several people")
        .number_between(1, 100)
        .show_default();
    verb.add_flag("--each-frame", options->each_frame, "triangulate each frame by itself, without the fit over time");
    verb.footer({kExtractFooter});
    verb.callback([options] { run_extract(*options); });
}

}  // namespace neuvv::tools

// neuvv dataset: what the program finds in a data set, to be looked at before hours of training.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <numbers>
#include <set>

#include "base/error.h"
#include "base/output_path.h"
#include "tools/commands.h"
#include "tools/data/dataset_files.h"
#include "tools/data/rig_drawing.h"
#include "tools/image_drawing.h"
#include "tools/options.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "tools/train/refine.h"
#include "training/data/contact_sheet.h"
#include "training/data/empty_mattes.h"
#include "training/data/images.h"
#include "training/data/layouts/formats.h"
#include "training/data/matte_sources.h"
#include "training/tree/camera_check.h"
#include "training/tree/hull_box.h"

namespace neuvv::tools {

namespace {

constexpr size_t kSampleCameras = 64, kSampleTimes = 3;  // whose images are read
constexpr size_t kMattesRead = 4096;                     // at most, to find empty ones
constexpr size_t kMaxPrintedNames = 40, kMaxPrintedMattes = 10;
constexpr uint32_t kSheetCell = 200;  // pixels, of the longer side of an image of the contact sheet

struct DatasetOptions {
    std::string folder, format = training::kAnyFormat, holdout, split = "train", output, as;
    bool search_rig = false;
    WrittenPart part;
};

using Box = std::pair<glm::dvec3, glm::dvec3>;

// What was found, or the message of the InputError that says why it was not: users run this verb to learn what is wrong
// with a data set.
template <typename T>
struct Finding {
    std::optional<T> found;
    std::string missing;
};

template <typename Find>
auto try_to_find(Find find) -> Finding<decltype(find())> {
    try {
        return {find(), ""};
    } catch (const InputError& error) {
        return {{}, message_of(error)};
    }
}

// At most `count` of the values, evenly spread, the first and the last included.
template <typename T>
std::vector<T> spread(const std::vector<T>& all, size_t count) {
    if (all.size() <= count) return all;
    std::vector<T> some;
    for (size_t i = 0; i < count; ++i) some.push_back(all[count == 1 ? 0 : i * (all.size() - 1) / (count - 1)]);
    return some;
}

// The rig with some of its cameras at some of its times; of a camera that has none of these times, its first image.
training::Rig sample_of(const training::Rig& rig) {
    std::set<double> times;
    std::map<uint32_t, std::vector<const training::Shot*>> shots;
    for (const training::Shot& shot : rig.shots) {
        times.insert(shot.time);
        shots[shot.camera].push_back(&shot);
    }
    const std::vector<double> sample_times = spread(std::vector<double>(times.begin(), times.end()), kSampleTimes);
    std::vector<uint32_t> cameras;
    for (const auto& [camera, of_camera] : shots) cameras.push_back(camera);
    training::Rig result = rig;
    result.cameras.clear();
    result.shots.clear();
    for (const uint32_t camera : spread(cameras, kSampleCameras)) {
        std::vector<const training::Shot*> selected;
        for (const training::Shot* shot : shots[camera])
            if (std::find(sample_times.begin(), sample_times.end(), shot->time) != sample_times.end())
                selected.push_back(shot);
        if (selected.empty()) selected.push_back(shots[camera][0]);
        for (const training::Shot* shot : selected) {
            result.shots.push_back(*shot);
            result.shots.back().camera = static_cast<uint32_t>(result.cameras.size());
        }
        result.cameras.push_back(rig.cameras[camera]);
    }
    return result;
}

// The share of the pixels that show the performer; nothing where no image has a matte.
std::optional<double> matte_share(const training::Dataset& dataset) {
    double opaque = 0, pixels = 0;
    bool clear = false;
    for (const training::View& view : dataset.views)
        for (uint32_t y = 0; y < view.image.height(); ++y)
            for (uint32_t x = 0; x < view.image.width(); ++x) {
                if (view.ignores(x, y)) continue;
                const uint8_t alpha = view.image.at(x, y)[3];
                clear |= alpha != 255;
                opaque += alpha / 255.0;
                pixels += 1;
            }
    if (!clear || pixels == 0) return {};
    return opaque / pixels;
}

constexpr const char* kLensTexts[] = {"pinhole", "radial and tangential distortion", "fisheye", "FOV"};  // by LensModel
constexpr const char* kMaskTexts[] = {"white is the performer, black the background; they become the images' mattes",
                                      "pixels of any value but 0 are the performer; they become the images' mattes",
                                      "white pixels are trained on, black ones are ignored",
                                      "black pixels are trained on, white ones are ignored"};  // by MaskMeaning

std::string range_text(double low, double high, int digits) {
    const std::string a = fmt::format("{:.{}f}", low, digits), b = fmt::format("{:.{}f}", high, digits);
    return a == b ? a : a + " to " + b;
}

std::string names_text(const std::vector<training::RigCamera>& cameras) {
    std::string text;
    for (size_t i = 0; i < std::min(cameras.size(), kMaxPrintedNames); ++i) text += " " + cameras[i].name;
    if (cameras.size() > kMaxPrintedNames) text += fmt::format(" and {} more", cameras.size() - kMaxPrintedNames);
    return text;
}

// A line of the report.
void print_field(const char* field, const std::string& text) {
    tell("{:<9} {}\n", field, text);
}

void print_lenses(const training::Rig& rig, const training::Dataset& sample) {
    std::set<std::string> models, sizes;
    double shortest = 1e30, longest = 0, widest = 0, narrowest = 180;
    for (const training::RigCamera& camera : rig.cameras) {
        models.insert(kLensTexts[camera.lens.distorts() ? static_cast<size_t>(camera.lens.model) : 0]);
        shortest = std::min({shortest, camera.lens.fx, camera.lens.fy});
        longest = std::max({longest, camera.lens.fx, camera.lens.fy});
    }
    for (const stage::Camera& camera : sample.cameras) {
        sizes.insert(fmt::format("{}×{}", camera.width, camera.height));
        const double angle = 2 * std::atan(0.5 * camera.width / camera.fx) * 180 / std::numbers::pi;
        widest = std::max(widest, angle);
        narrowest = std::min(narrowest, angle);
    }
    print_field("lenses", fmt::format("{}; focal length {} pixels, {}° wide", fmt::join(models, ", "),
                                      range_text(shortest, longest, 1), range_text(narrowest, widest, 1)));
    print_field("size", fmt::format("{}", fmt::join(sizes, ", ")));
}

void print_frames(const training::Rig& rig) {
    std::set<double> times;
    for (const training::Shot& shot : rig.shots) times.insert(shot.time);
    const size_t whole = times.size() * rig.cameras.size();
    print_field("frames", fmt::format("{}{}", times.size(),
                                      rig.fps > 0 ? fmt::format(" at {:g} fps", rig.fps) : ", frame rate not given"));
    print_field("images", rig.shots.size() == whole ? fmt::format("{}, every camera at every time", rig.shots.size())
                                                    : fmt::format("{}, {} fewer than cameras × frames",
                                                                  rig.shots.size(), whole - rig.shots.size()));
}

// Where the mattes come from, and what they overrule.
std::string sources_text(const std::vector<std::string>& sources) {
    if (sources.empty()) return "";
    if (sources.size() == 1) return "; from " + sources[0];
    return fmt::format("; from {}, which overrules {}", sources[0],
                       fmt::join(sources.begin() + 1, sources.end(), " and "));
}

void print_layers(const training::Rig& rig, const DatasetOptions& options, const std::optional<double>& matte) {
    const auto masks = std::count_if(rig.shots.begin(), rig.shots.end(),
                                     [](const training::Shot& shot) { return !shot.mask.path.empty(); });
    const auto plates = std::count_if(rig.cameras.begin(), rig.cameras.end(),
                                      [](const training::RigCamera& camera) { return !camera.plate.path.empty(); });
    print_field("masks",
                masks == 0 ? "none" : fmt::format("{}; {}", masks, kMaskTexts[static_cast<size_t>(rig.masks)]));
    print_field("plates", plates == 0 ? "none" : fmt::format("of {} cameras", plates));
    print_field(
        "mattes",
        matte ? fmt::format("yes; the performer fills {:.1f} % of an image{}", 100 * *matte,
                            sources_text(training::matte_sources({rig})))
              : fmt::format("none: make them with `neuvv matte {}`, or train whole images with --background learn",
                            options.folder));
}

// Boxes are printed in the coordinates of the capture.
void print_box(const training::Rig& rig, const Finding<Box>& hull) {
    const std::optional<Box>& given = rig.box;
    const auto text = [&](const Box& box) {
        const glm::dvec3 a = rig.frame.to_capture(box.first), b = rig.frame.to_capture(box.second);
        if (rig.frame.unit < 1)
            return fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})", a.x, a.y, a.z, b.x, b.y, b.z);
        return fmt::format("({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, {:.3f})", a.x, a.y, a.z, b.x, b.y, b.z);
    };
    print_field("box", given ? text(*given) + ", given by the files" : "not given");
    print_field("hull", hull.found ? text(*hull.found) + ", what the mattes leave at the sampled times" : hull.missing);
}

// The sampled images stand for all.
void print_memory(const training::Rig& rig, const training::Rig& sample, const training::Dataset& images) {
    const double kept = static_cast<double>(training::image_bytes(images)) /
                        static_cast<double>(std::max<uint64_t>(training::image_count(sample).bytes, 1));
    const uint64_t all = training::image_count(rig).bytes;
    print_field("memory", fmt::format("about {} for these images in training ({} with all background), next to the "
                                      "model; half of what is free is {}",
                                      size_text(static_cast<uint64_t>(kept * static_cast<double>(all))), size_text(all),
                                      size_text(training::image_budget())));
}

// One black matte among good ones makes a hole in its moment's hull; the sample of times misses it.
void print_empty_mattes(const training::Rig& rig) {
    StatusLine line(false);
    const auto progress = [&](uint64_t done, uint64_t total) {
        if (line.is_due()) line.print(fmt::format("mattes {}/{}", done, total));
    };
    const auto empty = try_to_find([&] { return training::find_empty_mattes(rig, kMattesRead, progress); });
    line.end();
    if (!empty.found) return print_field("note", empty.missing);
    const std::vector<uint32_t>& shots = empty.found->shots;
    for (size_t i = 0; i < std::min(shots.size(), kMaxPrintedMattes); ++i)
        tell("empty matte: {} shows nothing of the performer, most other images of its time do\n",
             rig.shots[shots[i]].name);
    if (shots.size() > kMaxPrintedMattes) tell("empty mattes: {} more\n", shots.size() - kMaxPrintedMattes);
    if (empty.found->looked_at < empty.found->times)
        tell("empty mattes were looked for at {} of {} times\n", empty.found->looked_at, empty.found->times);
}

void draw(const std::filesystem::path& folder, const training::Rig& rig, const std::vector<training::RigCamera>& train,
          const std::vector<training::RigCamera>& test, const training::Dataset& sample,
          const std::optional<Box>& box) {
    media::write_png(folder / "rig.png", draw_rig(train, test, box));
    std::vector<media::Image> images;
    std::vector<std::string> names;
    for (const training::View& view : sample.views) {
        if (view.camera != images.size()) continue;  // only the first image of each camera
        images.push_back(view.image.whole());
        names.push_back(rig.cameras[view.camera].name);
    }
    const auto columns = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(images.size()))));
    media::Image sheet = training::contact_sheet(images, columns, kSheetCell);
    const uint32_t rows = (static_cast<uint32_t>(images.size()) + columns - 1) / columns;
    for (uint32_t i = 0; i < names.size(); ++i)
        draw_text(sheet, static_cast<int>(i % columns * (sheet.width / columns) + 4),
                  static_cast<int>(i / columns * (sheet.height / rows) + 4), names[i], {200, 0, 120});
    media::write_png(folder / "contact_sheet.png", sheet);
    tell("wrote {} and contact_sheet.png\n", (folder / "rig.png").string());
}

// Trains a draft of the training images, and says what it found out about each camera.
void report_rig(const DatasetOptions& options, const CommonOptions& common) {
    catch_stop_signals();
    const gpu::Device device(common.device);
    training::Rig rig = training::read_rig(options.folder, training::Split::kTrain, options.format, options.holdout);
    training::check_cameras(rig);
    training::Dataset dataset = training::read_images(rig, {.format = options.format});
    training::ignore_doubtful_mattes(dataset);
    const auto found = search_rig(device, dataset, {.steps = UINT32_MAX}, {true, true, true}, true);
    if (!found) {
        tell("interrupted\n");
        return;
    }
    print_findings(*found, rig.cameras);
    if (options.output.empty()) return;
    const std::filesystem::path path = std::filesystem::path(options.output) / "cameras.png";
    media::write_png(path, draw_findings(*found, rig.cameras));
    tell("wrote {}\n", path.string());
}

void run(const DatasetOptions& options) {
    if (!options.output.empty()) {
        std::vector<std::string> names{"rig.png", "contact_sheet.png"};
        if (options.search_rig) names.emplace_back("cameras.png");
        prepare_results("--output", options.output, names);
    }
    const auto read = [&](training::Split split) {
        return try_to_find([&] { return training::read_rig(options.folder, split, options.format, options.holdout); });
    };
    const Finding<training::Rig> train = read(training::Split::kTrain), test = read(training::Split::kTest);
    const Finding<training::Rig>& requested = options.split == "train" ? train : test;
    if (!requested.found)  // throws its InputError again
        training::read_rig(options.folder, options.split == "train" ? training::Split::kTrain : training::Split::kTest,
                           options.format, options.holdout);
    training::Rig rig = *requested.found;
    if (options.split == "train")
        try_to_find([&] {
            training::check_cameras(rig);
            return true;
        });
    if (options.split == "train") std::ranges::copy(training::advice_on(rig), std::back_inserter(rig.remarks));
    const training::Rig sample = sample_of(rig);
    training::Dataset images = training::read_images(sample, {.mattes_needed = false});
    const std::optional<double> matte = matte_share(images);
    std::vector<training::DoubtfulMatte> doubtful;
    const auto find_hull = [&] {
        doubtful = training::ignore_doubtful_mattes(images);
        return training::hull_box(images);
    };
    const auto hull = matte ? try_to_find(find_hull) : Finding<Box>{{}, "not known without mattes"};
    tell("{}: {}, calibrated by {}\n", options.folder, rig.format, rig.file);
    for (const auto& [name, split] : {std::pair("train", &train), std::pair("test", &test)})
        print_field(name, split->found ? fmt::format("{} cameras:{}", split->found->cameras.size(),
                                                     names_text(split->found->cameras))
                                       : "none: " + split->missing);
    tell("of the {} split:\n", options.split);
    print_field("world", rig.world);
    print_lenses(rig, images);
    print_frames(rig);
    print_layers(rig, options, matte);
    print_box(rig, hull);
    print_memory(rig, sample, images);
    for (const std::string& remark : rig.remarks) print_field("note", remark);
    tell("{}", doubtful_mattes_text(images, doubtful));
    if (matte) print_empty_mattes(rig);
    if (options.output.empty()) return;
    const auto cameras = [](const Finding<training::Rig>& split) {
        return split.found ? split.found->cameras : std::vector<training::RigCamera>();
    };
    draw(options.output, sample, cameras(train), cameras(test), images, hull.found ? hull.found : rig.box);
}

}  // namespace

void add_dataset(Command app, CommonOptions& common) {
    Command verb = app.add_verb("dataset", "Say what a data set holds, and draw its cameras and images");
    const auto options = std::make_shared<DatasetOptions>();
    verb.add_option("dataset", options->folder, "The data set's folder").required();
    add_format_option(verb, options->format);
    add_holdout_option(verb, options->holdout);
    Option split =
        verb.add_option("--split", options->split, "Whose images are read").one_of({"train", "test"}).show_default();
    Option output =
        verb.add_option("-o,--output", options->output,
                        "Write rig.png (cameras and the scene's box from above and from the side; train blue, test "
                        "orange) and contact_sheet.png (an image of each camera) into this folder");
    Option rig = verb.add_flag(
        "--rig", options->search_rig,
        "Also train a draft of the training images, for a minute or more, and print for each camera what it says: how "
        "far its images are off, its gains, exposures, vignetting, how late its shutter is, and whether that rolls; "
        "with -o, cameras.png shows it");
    Option as =
        verb.add_option("--as", options->as,
                        "Instead, write all images into this folder, without lens distortion, for other programs: as "
                        "transforms_train.json, transforms_test.json, transforms_val.json where there is a validation, "
                        "images/, mattes/, masks/ and plates/")
            .one_of({"transforms"})
            .needs(output)
            .excludes(split)
            .excludes(rig);
    verb.add_option("--frames", options->part.frames,
                    "With --as: only the frames FIRST:LAST, counted from 0, as in 0:299")
        .needs(as);
    verb.add_option("--reduce", options->part.reduction,
                    "With --as: images smaller by this factor, a pixel being the mean of so many times so many")
        .in_range(1u, 16u)
        .show_default()
        .needs(as);
    verb.footer(
        {"Reads the calibration whole, of the images those of at most 64 cameras at 3 times, and of the mattes up to "
         "4096,\nto name empty ones; --rig reads all training images.\n"
         "Layouts: transforms.json, COLMAP, EasyMocap, Neural 3D Video, Metashape (.xml), RealityCapture (.csv),\n"
         "Qualisys (.qca.txt), Pose2Sim (Calib.toml), OpenCV (<camera>.yml), Panoptic Studio (calibration_*.json),\n"
         "Dynamic 3D Gaussians (train_meta.json), ActorsHQ (calibration.csv), Polycam, Record3D.\n"
         "training/data/layouts/README.md describes them.\n\n"
         "Examples, after `neuvv capture tools/performer/performer.glb -o work/performer`:\n"
         "  neuvv dataset work/performer\n"
         "  neuvv dataset work/performer -o work/look\n"
         "  neuvv dataset work/performer --rig -o work/rig\n"
         "  neuvv dataset work/performer --split test --format nerf\n"
         "  neuvv dataset work/performer -o work/copy --as transforms\n"
         "  neuvv dataset work/performer -o work/small --as transforms --frames 0:9 --reduce 2"});
    verb.callback([options, &common] {
        if (!options->as.empty())
            return write_as_transforms(options->folder, options->format, options->holdout, options->output,
                                       options->part);
        run(*options);
        if (options->search_rig) report_rig(*options, common);
    });
}

}  // namespace neuvv::tools

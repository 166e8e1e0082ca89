// neuvv eval: measures a scene against the images of a data set.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "tools/commands.h"
#include "tools/eval/eval_page.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "training/data/contact_sheet.h"
#include "training/data/images.h"
#include "training/data/layouts/formats.h"
#include "training/evaluation/evaluate.h"
#include "training/evaluation/flicker.h"
#include "training/evaluation/lpips.h"
#include "training/rig/align_rig.h"
#include "training/tree/camera_check.h"
#include "voctree/files/clip_index.h"
#include "voctree/files/world_frame.h"

namespace neuvv::tools {

namespace {

// More rays per pixel than a video needs, so that the numbers measure the scene and not the aliasing of its edges.
constexpr uint32_t kMeasureSamples = 4;
constexpr size_t kSheetRows = 8, kPageImages = 12;
constexpr uint32_t kComparisonCell = 320;
constexpr uint8_t kBlack[3] = {};

const std::map<std::string, training::Split> kSplits = {
    {"test", training::Split::kTest}, {"train", training::Split::kTrain}, {"val", training::Split::kVal}};

const std::map<std::string, const uint8_t*> kBackgrounds = {{"white", media::kWhite}, {"black", kBlack}};

const std::map<std::string, training::ComparedPart> kCrops = {{"none", training::ComparedPart::kImage},
                                                              {"rectangle", training::ComparedPart::kRectangle},
                                                              {"matte", training::ComparedPart::kMatte}};

struct EvalOptions {
    std::string scene, dataset, format = training::kAnyFormat, holdout, split = "test", json, images, html,
                                per = "camera", background = "white", crop = "none", lpips;
    uint32_t samples = kMeasureSamples;
    bool align = false;
    std::optional<voctree::UpAxis> up;
};

nlohmann::ordered_json json_of(const training::Quality& quality) {
    return {{"psnr", quality.psnr}, {"ssim", quality.ssim}, {"mae", quality.mae}, {"flip", quality.flip}};
}

double mean_lpips(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(std::max<size_t>(values.size(), 1));
}

// Adds the numbers of a camera's or a frame's images to the JSON that names it.
nlohmann::ordered_json group_json(nlohmann::ordered_json json, const training::Evaluation::Group& group) {
    json.update(json_of(group.quality));
    json["images"] = group.images;
    return json;
}

// `lpips`: one distance per view, or empty.
nlohmann::ordered_json json_of(const EvalOptions& options, const training::Dataset& dataset,
                               const training::Evaluation& evaluation, const std::vector<double>& lpips) {
    nlohmann::ordered_json json = json_of(evaluation.mean);
    if (!lpips.empty()) json["lpips"] = mean_lpips(lpips);
    json["file"] = options.scene;
    json["dataset"] = options.dataset;
    json["split"] = options.split;
    json["samples"] = options.samples;
    json["background"] = options.background;
    json["crop"] = options.crop;
    json["cameras"] = json["frames"] = json["images"] = nlohmann::ordered_json::array();
    const std::vector<std::string> labels = training::camera_labels(dataset);
    for (size_t i = 0; i < evaluation.cameras.size(); ++i)
        json["cameras"].push_back(group_json({{"camera", i}, {"name", labels[i]}}, evaluation.cameras[i]));
    for (size_t i = 0; i < evaluation.frames.size(); ++i)
        json["frames"].push_back(group_json({{"frame", i}, {"time", dataset.times[i]}}, evaluation.frames[i]));
    for (size_t i = 0; i < evaluation.views.size(); ++i) {
        const training::View& view = dataset.views[i];
        nlohmann::ordered_json image = {{"name", view.name},
                                        {"camera", view.camera},
                                        {"frame", training::frame_of_view(dataset, view)},
                                        {"time", view.time}};
        image.update(json_of(evaluation.views[i]));
        if (!lpips.empty()) image["lpips"] = lpips[i];
        json["images"].push_back(image);
    }
    return json;
}

// Writes each view's three images as they come, and the contact sheet at the end.
struct ImageFolder {
    std::filesystem::path folder;
    std::vector<size_t> sheet_views;
    std::vector<media::Image> sheet = {};

    void add(size_t view, const std::string& name, const media::Image& truth, const media::Image& render) {
        const media::Image error = training::error_image(truth, render);
        media::write_png(folder / (name + "_truth.png"), truth);
        media::write_png(folder / (name + "_render.png"), render);
        media::write_png(folder / (name + "_error.png"), error);
        if (std::binary_search(sheet_views.begin(), sheet_views.end(), view))
            sheet.insert(sheet.end(), {truth, render, error});
    }
    void finish() const {
        media::write_png(folder / "contact_sheet.png", training::contact_sheet(sheet, 3, kComparisonCell));
    }
};

// Keeps the images that the page shows: selected views, spread over cameras and times, and the worst of all.
struct PageCollector {
    std::vector<size_t> selected_views;
    std::vector<PageImage> images = {};
    PageImage worst = {};
    double worst_psnr = 1e9;

    void add(size_t view, const media::Image& truth, const media::Image& render, double psnr) {
        if (std::binary_search(selected_views.begin(), selected_views.end(), view))
            images.push_back({view, truth, render});
        if (psnr >= worst_psnr) return;
        worst_psnr = psnr;
        worst = {view, truth, render};
    }
    void finish() {
        if (!std::binary_search(selected_views.begin(), selected_views.end(), worst.view))
            images.push_back(std::move(worst));
    }
};

void print_row(const std::string& name, size_t images, const training::Quality& quality) {
    tell("{:<12} {:>7} {:>9.3f} {:>9.5f} {:>9.5f} {:>9.5f}\n", name, images, quality.psnr, quality.ssim, quality.mae,
         quality.flip);
}

void print(const training::Evaluation& evaluation, const training::Dataset& dataset, const std::string& per) {
    tell("{:<12} {:>7} {:>9} {:>9} {:>9} {:>9}\n", per, "images", "PSNR dB", "SSIM", "MAE", "FLIP");
    const std::vector<std::string> labels = training::camera_labels(dataset);
    const std::vector<training::Evaluation::Group>& groups = per == "frame" ? evaluation.frames : evaluation.cameras;
    for (size_t i = 0; i < groups.size(); ++i)
        print_row(per == "frame" ? std::to_string(i) : labels[i], groups[i].images, groups[i].quality);
    print_row("mean", evaluation.compared, evaluation.mean);
}

// The steps from frame to frame over which a segment gives way to the next: where there is no overlap, a single one.
std::vector<size_t> cuts_of(const voctree::ClipIndex& clip) {
    if (clip.plays_by_frame()) return {};
    std::set<size_t> steps;
    for (size_t i = 1; i < clip.segments.size(); ++i)
        for (size_t step = 0; step <= voctree::fade_frames(clip, i - 1); ++step)
            steps.insert(clip.segments[i].first - 1 + step);
    return {steps.begin(), steps.end()};
}

void print(const training::FlickerMeter::Summary& flicker) {
    tell("flicker, steps of 255 from frame to frame: {:.2f} where the truth stands still, {:.2f} where it moves\n",
         flicker.others.still, flicker.others.moving);
    if (flicker.cut_count > 0)
        tell("in {} steps from segment to segment: {:.2f} ({:.2f} times) and {:.2f} ({:.2f} times)\n",
             flicker.cut_count, flicker.cuts.still, flicker.cuts.still / flicker.others.still, flicker.cuts.moving,
             flicker.cuts.moving / flicker.others.moving);
}

nlohmann::ordered_json json_of(const training::FlickerMeter::Summary& flicker) {
    nlohmann::ordered_json json = {{"still", flicker.others.still}, {"moving", flicker.others.moving}};
    if (flicker.cut_count > 0)
        json.update({{"cuts", flicker.cut_count},
                     {"still_at_cuts", flicker.cuts.still},
                     {"moving_at_cuts", flicker.cuts.moving}});
    return json;
}

// Moves the cameras of the data set as one, and says by how much.
training::RigAlignment align(const gpu::Device& device, const voctree::ClipIndex& clip, training::Dataset& dataset) {
    constexpr uint64_t kSteps = 1000;
    Progress progress("align", kSteps);
    const training::RigAlignment found = training::align_rig(device, clip, dataset, [&](double fraction) {
        progress.update(static_cast<uint64_t>(fraction * kSteps));
        return !stop_requested();
    });
    progress.finish();
    if (stop_requested()) throw RuntimeFailure("stopped before the cameras were aligned");
    for (stage::Camera& camera : dataset.cameras) camera = training::moved(camera, found.motion, found.centre);
    return found;
}

std::string text_of(const training::RigAlignment& alignment) {
    const training::RigMotion& motion = alignment.motion;
    return fmt::format(
        "cameras moved as one by {:.2f} pixels: turned by {:.3f}°, shifted by {:.4f} m, scaled by {:.5f}",
        alignment.motion_px, glm::degrees(glm::length(motion.turn)), glm::length(motion.shift),
        std::exp(motion.log_scale));
}

nlohmann::ordered_json json_of(const training::RigAlignment& alignment) {
    const training::RigMotion& motion = alignment.motion;
    return {{"pixels", alignment.motion_px},
            {"turn", {motion.turn.x, motion.turn.y, motion.turn.z}},
            {"shift", {motion.shift.x, motion.shift.y, motion.shift.z}},
            {"scale", std::exp(motion.log_scale)},
            {"centre", {alignment.centre.x, alignment.centre.y, alignment.centre.z}}};
}

double distance(const training::Lpips& network, const training::View& view, training::ComparedPart part,
                const media::Image& truth, const media::Image& render) {
    return network.distance(training::compared_part(truth, view, part, training::Lpips::kMinSide),
                            training::compared_part(render, view, part, training::Lpips::kMinSide));
}

PageFacts page_facts(const EvalOptions& options, const std::string& device, const std::string& note) {
    const std::string part = options.crop == "none"    ? ""
                             : options.crop == "matte" ? ", the rectangle around the matte; PSNR: the matte's pixels"
                                                       : ", the rectangle around the matte";
    return {options.scene, options.dataset, options.split, device, "over " + options.background + part, note};
}

// Throws InputError, before any work is done, where a result could not be written.
void prepare_outputs(const EvalOptions& options) {
    if (!options.json.empty() && options.json != "-") prepare_result("--json", options.json, kJsonEnding);
    if (!options.html.empty()) prepare_result("--html", options.html, kHtmlEndings);
    if (!options.images.empty()) prepare_results("--images", options.images, {"contact_sheet.png"});
}

// On stderr, as tables and JSON are read by other programs.
void say_what_was_written(const EvalOptions& options) {
    for (const std::string& written : {options.json == "-" ? "" : options.json, options.html})
        if (!written.empty()) say("wrote {}\n", written);
    if (!options.images.empty())
        say("wrote truth, render and error of each image and contact_sheet.png into {}\n", options.images);
}

void run(const EvalOptions& options, const CommonOptions& common) {
    prepare_outputs(options);
    const voctree::ClipIndex clip = voctree::read_clip_index(options.scene, up_of(options.scene, options.up));
    training::Rig rig = training::read_rig(options.dataset, kSplits.at(options.split), options.format, options.holdout);
    if (kSplits.at(options.split) == training::Split::kTrain) training::check_cameras(rig);  // as training does
    training::Dataset dataset = training::read_images(
        rig, {.format = options.format, .holdout = options.holdout, .mattes_needed = clip.frames() > 1});
    if (!training::has_mattes(dataset))
        say("no image of {} has a matte: all of each is compared, as a still by --background learn shows it\n",
            options.dataset);
    say_remarks(dataset.remarks);
    training::change_frame(dataset, voctree::read_world_frame(options.scene));
    if (clip.frames() != dataset.times.size())
        say("neuvv: {} has {} frames, {} has images of {} times: each is compared with the scene at its time\n",
            options.scene, clip.frames(), options.dataset, dataset.times.size());
    std::optional<training::Lpips> network;
    if (!options.lpips.empty()) network.emplace(options.lpips);
    std::vector<double> lpips(network ? dataset.views.size() : 0);
    ImageFolder folder{options.images, training::spread_views(dataset, kSheetRows)};
    PageCollector page{training::spread_views(dataset, kPageImages)};
    const training::CompareSettings settings{options.samples, kCrops.at(options.crop),
                                             kBackgrounds.at(options.background)};
    training::FlickerMeter meter(dataset.cameras.size(), dataset.times.size(), settings.background);
    const gpu::Device device(common.device);
    catch_stop_signals();
    std::optional<training::RigAlignment> alignment;
    if (options.align) alignment = align(device, clip, dataset);
    Progress progress("eval", dataset.views.size());
    size_t compared = 0;
    double sum = 0;  // of PSNR
    const training::ViewCallback done = [&](size_t view, const media::Image& truth, const media::Image& render,
                                            const training::Quality& quality) {
        if (!options.images.empty()) folder.add(view, dataset.views[view].name, truth, render);
        if (!options.html.empty()) page.add(view, truth, render, quality.psnr);
        meter.add(dataset.views[view].camera, training::frame_of_view(dataset, dataset.views[view]), truth, render);
        if (network) lpips[view] = distance(*network, dataset.views[view], settings.part, truth, render);
        sum += quality.psnr;
        ++compared;
        progress.update(compared, fmt::format("mean {:.2f} dB", sum / static_cast<double>(compared)));
        return !stop_requested();
    };
    const training::Evaluation evaluation = training::evaluate(device, clip, dataset, settings, done);
    progress.finish();
    if (evaluation.compared < dataset.views.size()) throw RuntimeFailure("stopped before the end; no means are given");
    if (!options.images.empty()) folder.finish();
    if (!options.html.empty()) {
        page.finish();
        const PageFacts facts = page_facts(options, device.summary().name, alignment ? text_of(*alignment) : "");
        write_text_file(options.html, comparison_page(facts, dataset, evaluation, page.images));
    }
    const auto flicker = meter.summary(clip.frames() == dataset.times.size() ? cuts_of(clip) : std::vector<size_t>());
    nlohmann::ordered_json facts = json_of(options, dataset, evaluation, lpips);
    if (flicker) facts["flicker"] = json_of(*flicker);
    if (alignment) facts["aligned"] = json_of(*alignment);
    if (!options.json.empty() && options.json != "-") write_text_file(options.json, json_text(facts));
    if (options.json == "-") {
        tell("{}", json_text(facts));
        return say_what_was_written(options);
    }
    print(evaluation, dataset, options.per);
    if (alignment) tell("{}\n", text_of(*alignment));
    if (flicker) print(*flicker);
    if (network) tell("LPIPS, mean over images: {:.5f}\n", mean_lpips(lpips));
    say_what_was_written(options);
}

}  // namespace

void add_eval(Command app, CommonOptions& common) {
    Command verb = app.add_verb("eval", "Measure a scene against the images of a data set");
    const auto options = std::make_shared<EvalOptions>();
    verb.add_option("scene", options->scene, "The .nvv, in segments or not, or the .npz of a PlenOctree").required();
    verb.add_option("dataset", options->dataset, "The data set's folder").required();
    add_format_option(verb, options->format);
    add_holdout_option(verb, options->holdout);
    verb.add_option("--split", options->split, "Which of its images").one_of({"test", "train", "val"}).show_default();
    add_samples_option(verb, options->samples);
    add_up_option(verb, options->up);
    verb.add_option("--json", options->json, "Write the numbers to this file (-: print them instead of the table)");
    verb.add_option("--images", options->images,
                    "Write NAME_truth.png, NAME_render.png, NAME_error.png of each image NAME, and contact_sheet.png "
                    "(rows of truth, render, error), into this folder");
    verb.add_option("--html", options->html,
                    "Write one page to this file that opens in any browser: images to slide over each other or to "
                    "blink between, curves over the clip, all numbers");
    verb.add_option("--background", options->background, "What is behind truth and render")
        .one_of({"white", "black"})
        .show_default();
    verb.add_option("--crop", options->crop,
                    "Compare a part of each image alone. rectangle: the smallest that holds the truth's matte; matte: "
                    "the same, and PSNR of the matte's pixels alone")
        .one_of({"none", "rectangle", "matte"})
        .show_default();
    verb.add_option("--per", options->per, "What a row of the table is: --json and --html hold both")
        .one_of({"camera", "frame"})
        .show_default();
    verb.add_flag("--align", options->align,
                  "First move all cameras of the split as one (a turn, a shift, a scaling) to where the scene fits "
                  "their images best. A scene trained with --refine poses needs it: no training image shows where the "
                  "rig as a whole stands");
    verb.add_option(
        "--lpips", options->lpips,
        "Also LPIPS 0.1 with AlexNet, its weights in this .npz (training/evaluation/README.md says how to export "
        "them): the mean, and in --json each image's");
    verb.footer(
        {"Each image is rendered with its own camera, size and time. Truth and render are 8-bit sRGB,\n"
         "composited over white (--background) in encoded values, and compared whole (--crop), values\n"
         "scaled to [0,1]:\n"
         "  PSNR  -10 log10(mean over pixels and R, G, B of the squared error), dB; at most 99\n"
         "  SSIM  Wang et al. 2004: Gaussian window of 11x11, sigma 1.5, K1 0.01, K2 0.03; mean over R, G, B\n"
         "        and the pixels whose whole window lies inside the image\n"
         "  MAE   mean absolute error\n"
         "  FLIP  LDR-FLIP (Andersson et al. 2020), mean over pixels, seen from 67 pixels per degree: 0 where\n"
         "        nobody sees a difference, at most 1\n"
         "Flicker is how much a render changes from frame to frame in another way than the truth, over the "
         "performer's\n"
         "pixels, in steps of 255: the median over the clip, and over the steps from segment to segment.\n"
         "The mean is over images, also per camera and per frame. In the error image, 0.25 and more is "
         "white.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv eval work/performer.nvv work/performer\n"
         "  neuvv eval work/performer.nvv work/performer --json work/metrics.json --images work/images\n"
         "  neuvv eval work/performer.nvv work/performer --html work/performer.html --per frame\n"
         "  neuvv eval work/performer.nvv work/performer --split train --json - | jq .psnr"});
    verb.callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::tools

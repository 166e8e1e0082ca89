// neuvv eval: a scene measured against the pictures of a data set.
#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/platform.h"
#include "tools/commands.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "training/evaluate.h"
#include "voctree/nvv.h"

namespace neuvv {

namespace {

constexpr size_t kSheetRows = 8;
constexpr uint32_t kSheetCell = 320;

struct EvalOptions {
    std::string scene, dataset, format = kAnyFormat, split = "test", json, images;
    uint32_t samples = kDefaultSamples;
};

nlohmann::ordered_json json_of(const Quality& quality) {
    return {{"psnr", quality.psnr}, {"ssim", quality.ssim}, {"mae", quality.mae}};
}

nlohmann::ordered_json json_of(const EvalOptions& options, const Dataset& dataset, const Evaluation& evaluation) {
    nlohmann::ordered_json json = json_of(evaluation.mean);
    json["file"] = options.scene;
    json["dataset"] = options.dataset;
    json["split"] = options.split;
    json["samples"] = options.samples;
    json["cameras"] = nlohmann::ordered_json::array();
    for (size_t i = 0; i < evaluation.cameras.size(); ++i) {
        nlohmann::ordered_json camera = {{"camera", i}};
        camera.update(json_of(evaluation.cameras[i].quality));
        camera["images"] = evaluation.cameras[i].images;
        json["cameras"].push_back(camera);
    }
    json["images"] = nlohmann::ordered_json::array();
    for (size_t i = 0; i < evaluation.views.size(); ++i) {
        const View& view = dataset.views[i];
        nlohmann::ordered_json image = {{"name", view.name}, {"camera", view.camera}, {"time", view.time}};
        image.update(json_of(evaluation.views[i]));
        json["images"].push_back(image);
    }
    return json;
}

// Views for the contact sheet: spread over the data set, first and last included.
std::set<size_t> sheet_views(size_t views) {
    std::set<size_t> chosen;
    const size_t rows = std::min(views, kSheetRows);
    for (size_t row = 0; row < rows; ++row) chosen.insert(rows == 1 ? 0 : row * (views - 1) / (rows - 1));
    return chosen;
}

// Writes each view's three pictures as they come, and the contact sheet in the end.
struct PictureFolder {
    std::filesystem::path folder;
    std::set<size_t> on_sheet;
    std::vector<Image> sheet = {};

    void add(size_t view, const std::string& name, const Image& truth, const Image& render) {
        const Image error = error_picture(truth, render);
        write_png(folder / (name + "_truth.png"), truth);
        write_png(folder / (name + "_render.png"), render);
        write_png(folder / (name + "_error.png"), error);
        if (on_sheet.count(view)) sheet.insert(sheet.end(), {truth, render, error});
    }
    void finish() const { write_png(folder / "contact_sheet.png", contact_sheet(sheet, 3, kSheetCell)); }
};

void print_row(const std::string& camera, size_t images, const Quality& quality) {
    fmt::print("{:<8} {:>7} {:>9.3f} {:>9.5f} {:>9.5f}\n", camera, images, quality.psnr, quality.ssim, quality.mae);
}

void print(const Evaluation& evaluation) {
    fmt::print("{:<8} {:>7} {:>9} {:>9} {:>9}\n", "camera", "images", "PSNR dB", "SSIM", "MAE");
    for (size_t i = 0; i < evaluation.cameras.size(); ++i)
        print_row(std::to_string(i), evaluation.cameras[i].images, evaluation.cameras[i].quality);
    print_row("mean", evaluation.views.size(), evaluation.mean);
}

void make_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw RuntimeFailure(fmt::format("{}: cannot make this folder: {}", folder, error.message()));
}

void run(const EvalOptions& options, const CommonOptions& common) {
    const VOctree tree = read_nvv(options.scene);
    const Dataset dataset = load_dataset(options.dataset, options.split == "train" ? Split::kTrain : Split::kTest,
                                         {.format = options.format});
    std::unique_ptr<PictureFolder> pictures;
    if (!options.images.empty()) {
        make_folder(options.images);
        pictures.reset(new PictureFolder{options.images, sheet_views(dataset.views.size())});
    }
    const Device device(common.device);
    catch_stop_signals();
    Progress progress("eval", dataset.views.size());
    const ViewCallback done = [&](size_t view, const Image& truth, const Image& render, const Quality& quality) {
        if (pictures) pictures->add(view, dataset.views[view].name, truth, render);
        progress.update(view + 1, fmt::format("{:.2f} dB", quality.psnr));
        return !stop_requested();
    };
    const Evaluation evaluation = evaluate(device, tree, dataset, options.samples, done);
    progress.finish();
    if (evaluation.views.size() < dataset.views.size())
        throw RuntimeFailure("stopped before the end; no means are given");
    if (pictures) pictures->finish();
    const std::string json = json_text(json_of(options, dataset, evaluation));
    if (options.json == "-") {
        fmt::print("{}", json);
        return;
    }
    if (!options.json.empty())
        write_file_atomically(options.json, [&](const ByteSink& sink) { sink(json.data(), json.size()); });
    print(evaluation);
}

}  // namespace

void add_eval(CLI::App& app, CommonOptions& common) {
    CLI::App* verb = app.add_subcommand("eval", "Measure a scene against the pictures of a data set");
    const auto options = std::make_shared<EvalOptions>();
    verb->add_option("scene", options->scene, "The .nvv file")->required();
    verb->add_option("dataset", options->dataset, "The data set's folder")->required();
    add_format_option(*verb, options->format);
    verb->add_option("--split", options->split, "Which of its pictures")
        ->check(CLI::IsMember({"test", "train"}))
        ->capture_default_str();
    add_samples_option(*verb, options->samples);
    verb->add_option("--json", options->json, "Write the numbers to this file (-: print them instead of the table)");
    verb->add_option(
        "--images", options->images,
        "Write NAME_truth.png, NAME_render.png, NAME_error.png of each picture NAME, and contact_sheet.png "
        "(rows of truth, render, error), into this folder");
    verb->footer(
        std::string(
            "Each picture is rendered with its own camera, size and time. Truth and render are 8-bit sRGB,\n"
            "composited over white in encoded values, and compared whole, values scaled to [0,1]:\n"
            "  PSNR  -10 log10(mean over pixels and R, G, B of the squared error), dB; at most 99\n"
            "  SSIM  Wang et al. 2004: Gaussian window of 11x11, sigma 1.5, K1 0.01, K2 0.03; mean over R, G, B\n"
            "        and the pixels whose whole window lies inside the picture\n"
            "  MAE   mean absolute error\n"
            "The mean is over pictures, also per camera. In the error picture, 0.25 and more is white.\n") +
        kDeviceHelp + kExamplesHead +
        "  neuvv eval build/performer.nvv build/performer\n"
        "  neuvv eval build/performer.nvv build/performer --json build/metrics.json --images build/pictures\n"
        "  neuvv eval build/performer.nvv build/performer --split train --json - | jq .psnr");
    verb->callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv

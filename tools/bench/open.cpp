// neuvv-bench open: how long until a scene's first image, of the coarse tree, and until that of the whole.
#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/platform.h"
#include "render/frame.h"
#include "tools/bench/measure.h"
#include "tools/bench/synthetic_scene.h"
#include "tools/bench/verbs.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "training/metrics.h"
#include "voctree/coarse.h"
#include "voctree/nvv.h"

namespace neuvv::bench {

namespace {

struct OpenOptions : BenchOptions {
    std::string images;
    double synthetic_megabytes = 0;
};

// Seconds of what stands between a path and an image.
struct Opening {
    uint32_t leaves = 0;
    double read = 0, check = 0, upload = 0, prepare = 0, render = 0;  // `check` is a part of `read`
    media::Image image;
    double total() const { return read + upload + prepare + render; }
};

double seconds_since(std::chrono::steady_clock::time_point& mark) {
    const auto before = std::exchange(mark, std::chrono::steady_clock::now());
    return std::chrono::duration<double>(mark - before).count();
}

// `view`: that of both images, found with the first tree; finding it takes no part in the times.
Opening open(const gpu::Device& device, const std::function<voctree::VOctree()>& read,
             std::optional<tools::ViewStep>& view, media::ImageSize size) {
    Opening result;
    auto mark = std::chrono::steady_clock::now();
    const voctree::VOctree tree = read();
    result.read = seconds_since(mark);
    if (!voctree::defect_of(tree).empty()) throw std::logic_error("a tree that was read has no defect");
    result.check = seconds_since(mark);
    result.leaves = tree.leaf_count;
    if (!view)
        view = tools::orbit_path(tools::occupied_box(tree), {{0, tree.frames - 1.0}, tree.fps, tree.fps}, size)[0];

    seconds_since(mark);
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    result.upload = seconds_since(mark);
    render::FrameRenderer renderer(device, field, {size.width, size.height});
    result.prepare = seconds_since(mark);
    render::FrameSettings settings;
    settings.instances[0].frame = static_cast<float>(view->frame);
    settings.width = size.width;
    settings.height = size.height;
    settings.resolve.background = {1, 1, 1, 1};
    settings.mode = render::TraceMode::kPlay;
    result.image = renderer.render(view->camera, settings);
    result.render = seconds_since(mark);
    return result;
}

nlohmann::ordered_json json_of(const Opening& opening) {
    return {{"leaves", opening.leaves},  {"total_s", opening.total()}, {"read_s", opening.read},
            {"check_s", opening.check},  {"upload_s", opening.upload}, {"prepare_s", opening.prepare},
            {"render_s", opening.render}};
}

void print(const char* name, const Opening& opening) {
    fmt::print("{:<12} {:>9} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f}\n", name, opening.leaves,
               opening.total(), opening.read, opening.check, opening.upload, opening.prepare, opening.render);
}

void report(const OpenOptions& options, const gpu::Device& device, uint64_t bytes, const std::optional<Opening>& first,
            const Opening& whole) {
    const double share = first ? first->total() / whole.total() : 1;
    const double psnr = first ? training::compare(whole.image, first->image).psnr : 99;
    if (options.json) {
        fmt::print("{}", tools::json_text({{"device", device.summary().name},
                                           {"scene", options.scene},
                                           {"bytes", bytes},
                                           {"size", options.size},
                                           {"first", first ? json_of(*first) : nlohmann::ordered_json()},
                                           {"whole", json_of(whole)},
                                           {"share", share},
                                           {"psnr_db", psnr}}));
        return;
    }
    fmt::print("{}: {}, {}, images of {}\n", device.summary().name, options.scene, tools::size_text(bytes),
               options.size);
    fmt::print("{:<12} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "seconds", "leaves", "total", "read", "checks",
               "upload", "prepare", "render");
    if (first) print("coarse tree", *first);
    print("whole tree", whole);
    if (first)
        fmt::print("the first image takes {:.1f} % of the time of the whole, and has {:.1f} dB against it\n",
                   100 * share, psnr);
    else
        fmt::print("the file has no coarse tree: fewer than {} leaves, or not written as such\n",
                   voctree::kMinLeavesForCoarse);
}

void write_synthetic(const OpenOptions& options) {
    if (std::filesystem::exists(options.scene))
        throw InputError(options.scene, "", "is there already", "name a new file, or leave --synthetic out");
    tools::prepare_output_file("scene", options.scene);
    const voctree::VOctree tree = synthetic_scene(options.synthetic_megabytes);
    voctree::write_nvv(options.scene, tree, {}, 1, voctree::coarse_tree(tree));
}

void run(const OpenOptions& options, const tools::CommonOptions& common) {
    const media::ImageSize size = tools::parse_size(options.size);
    if (!options.images.empty()) tools::prepare_output_folder("--pictures", options.images);
    if (options.synthetic_megabytes > 0) write_synthetic(options);
    const voctree::NvvSummary summary = voctree::summarise_nvv(options.scene);
    const bool has_coarse = summary.chunks.size() > 1 && summary.chunks[1].name == "hEAD";
    const gpu::Device device(common.device);
    std::optional<tools::ViewStep> view;
    std::optional<Opening> first;
    if (has_coarse)
        first = open(
            device, [&] { return *voctree::read_nvv_coarse(options.scene); }, view, size);
    const Opening whole = open(
        device, [&] { return voctree::read_nvv(options.scene); }, view, size);
    if (!options.images.empty()) {
        if (first) media::write_png(std::filesystem::path(options.images) / "coarse.png", first->image);
        media::write_png(std::filesystem::path(options.images) / "whole.png", whole.image);
    }
    report(options, device, summary.file_bytes, first, whole);
}

}  // namespace

void add_open(CLI::App& app, const tools::CommonOptions& common) {
    const auto options = std::make_shared<OpenOptions>();
    CLI::App* verb =
        add_verb(app,
                 {"open",
                  "From a scene's path to its first image, and to the whole",
                  "Times one opening each of the coarse tree, which stands first in the file, and of the whole: read "
                  "(unpacked and checked;\nhow long the checks of the tree take of it is measured once more, apart), "
                  "upload, prepare (the renderer and its\npipelines), render (the first image, its slice "
                  "included). Finding the device is not counted. The system's cache\nof files is used as it is, and "
                  "the coarse opening, which is first, also compiles the pipelines. ",
                  {"build/performer.nvv", "build/large.nvv --synthetic 1000"}},
                 *options);
    verb->add_option("--synthetic", options->synthetic_megabytes,
                     "First write a made-up scene of about so many MB there; it stays. 1000 MB are about what devices "
                     "hold in one "
                     "buffer")
        ->check(tools::number_between(1, 1000));
    add_size_option(*verb, *options);
    verb->add_option("--pictures", options->images, "A folder for the two images: coarse.png and whole.png");
    add_json_flag(*verb, *options);
    verb->callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::bench

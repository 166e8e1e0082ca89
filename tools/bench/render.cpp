// neuvv-bench render: compares the paths of the renderer, the paper's included, in time and in their images.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>
#include <variant>

#include "base/platform.h"
#include "render/volume/reference_paths.h"
#include "tools/bench/rivals.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "voctree/files/clip.h"

namespace neuvv::bench {

namespace {

struct RenderOptions : BenchOptions {
    std::string rival;  // raster, or none
};

// How many views share a slice when a clip of 25 frames a second plays on a display of 90 Hz for two eyes.
constexpr double kViewsPerSlice = 2 * 90 / 25.0;

// A path of the renderer, and how long its frames took.
struct Path {
    const char* name;
    const char* key;  // in JSON
    std::variant<render::TraceMode, render::ReferencePath> mode;
    std::vector<double> slice_ms, rest_ms;  // of each image: building its slice, and everything else
    // Of an image that needs so many slices.
    double seconds(double slices) const { return (slices * median(slice_ms) + median(rest_ms)) / 1000; }
    double p99_ms(double slices) const { return slices * median(slice_ms) + quantile(rest_ms, 0.99); }
};

double part_ms(const std::vector<gpu::PassTime>& passes, bool of_slice) {
    double sum = 0;
    for (const gpu::PassTime& pass : passes)
        if (pass.name != kReadbackPass && pass.name.starts_with("slice") == of_slice) sum += pass.milliseconds;
    return sum;
}

struct RenderResult {
    std::vector<Path> paths;
    std::vector<PassSum> passes;  // of the shaded images
    HostTimes host;
    RivalTimes rival;
    std::vector<double> trace_ms;  // of the device for the same rays as the host
    double copy_gb_s = 0;          // bytes read and written
    double covered = 0;            // share of the pixels
    Differences differences;       // of the shaded images from the paper's
    uint64_t rays = 0;
};

struct Renderers {
    Renderers(const gpu::Device& device, const render::Field& field, media::ImageSize size)
        : frames(device, field, {size.width, size.height}), references(device, field, size.width, size.height) {}
    render::FrameRenderer frames;
    render::ReferenceRenderer references;
};

// Draws an image whose slice is built anew, to `image` where there is one.
std::vector<gpu::PassTime> draw(Renderers& renderers, const Path& path, const tools::ViewStep& view,
                                media::Image* image = nullptr) {
    const auto frame = static_cast<float>(view.frame);
    if (const auto* reference = std::get_if<render::ReferencePath>(&path.mode)) {
        render::ReferenceSettings settings{.path = *reference, .frame = frame};
        settings.resolve.background = {1, 1, 1, 1};
        media::Image drawn = renderers.references.render(view.camera, settings);
        if (image) *image = std::move(drawn);
        return renderers.references.pass_times();
    }
    render::FrameSettings settings = play_settings({view.camera.width, view.camera.height});
    settings.instances[0].frame = frame;
    settings.mode = std::get<render::TraceMode>(path.mode);
    renderers.frames.forget_slices();
    if (image)
        *image = renderers.frames.render(view.camera, settings);
    else
        renderers.frames.draw({&view.camera, 1}, settings);
    return renderers.frames.pass_times();
}

constexpr uint32_t kCallsOfFastPath = 20;  // in a second

// Adds to the times of a path; returns the last image.
media::Image measure(Renderers& renderers, Path& path, const tools::ViewStep& view, uint32_t repeats,
                     uint32_t repeats_if_slow, RenderResult& result) {
    // Paths without a slice take seconds on some devices.
    if (warm_up([&] { draw(renderers, path, view); }) < kCallsOfFastPath) repeats = std::min(repeats, repeats_if_slow);
    const auto* mode = std::get_if<render::TraceMode>(&path.mode);
    for (uint32_t i = 0; i < repeats && !stop_requested(); ++i) {
        const std::vector<gpu::PassTime> passes = draw(renderers, path, view);
        path.slice_ms.push_back(part_ms(passes, true));
        path.rest_ms.push_back(part_ms(passes, false));
        if (!mode || *mode != render::TraceMode::kShaded) continue;
        add_image(result.passes, passes);
        for (const gpu::PassTime& pass : passes)
            if (pass.name == "trace") result.trace_ms.push_back(pass.milliseconds);
    }
    media::Image image;
    draw(renderers, path, view, &image);
    return image;
}

RenderResult measure_all(const gpu::Device& device, const voctree::VOctree& tree, const RenderOptions& options) {
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    const media::ImageSize size = tools::parse_size(options.size);
    const std::vector<tools::ViewStep> orbit = tools::orbit_path(tree, size);
    RenderResult result;
    result.rays = uint64_t{size.width} * size.height;
    result.paths = {{"the paper's: from the root, all numbers", "paper", render::ReferencePath::kPaper, {}, {}},
                    {"all numbers, our walk", "direct", render::ReferencePath::kDirect, {}, {}},
                    {"slice in slots, our walk", "slice", render::ReferencePath::kSlots, {}, {}},
                    {"slice tree and tile ranges", "tree", render::TraceMode::kTree, {}, {}},
                    {"the same, shaded", "shaded", render::TraceMode::kShaded, {}, {}}};
    Renderers renderers(device, field, size);
    const render::FrameRenderer& renderer = renderers.frames;
    tools::Progress progress("bench", options.views * result.paths.size());
    for (uint32_t i = 0; i < options.views && !stop_requested(); ++i) {
        const tools::ViewStep& view = orbit[i * orbit.size() / options.views];
        media::Image truth;
        for (size_t p = 0; p < result.paths.size() && !stop_requested(); ++p) {
            const uint32_t repeats_if_slow = p < 2 ? 1 : options.repeats;
            const media::Image image =
                measure(renderers, result.paths[p], view, options.repeats, repeats_if_slow, result);
            if (p == 0) truth = image;
            if (p + 1 == result.paths.size()) {
                result.differences.add(truth, image);
                if (!options.rival.empty())
                    measure_rival(device, field, renderer, view.camera, image, options.repeats, result.rival);
            }
            progress.update(i * result.paths.size() + p + 1);
        }
        expect_not_stopped();
        const std::vector<glm::vec4> rays = renderer.radiance();
        result.covered += static_cast<double>(covered_rays(rays)) / static_cast<double>(rays.size()) / options.views;
        measure_host(device, field, renderer, view.camera, options.repeats, result.host);
    }
    result.copy_gb_s = 1e-9 * copied_bytes_per_second(device);
    return result;
}

// What a ray in a tile that may see a leaf reads on average.
struct RayWork {
    double nodes = 0, descents = 0, entries = 0, bytes = 0;
    double gb_s = 0;  // read by all rays during the trace
};

RayWork work_of(const RenderResult& result) {
    const MarchCounts& counts = result.host.counts;
    const auto rays = static_cast<double>(std::max<uint64_t>(counts.rays, 1));
    const auto of = [rays](uint64_t count) { return static_cast<double>(count) / rays; };
    const double rays_per_image = rays / std::max(result.host.images, 1u);
    return {of(counts.nodes), of(counts.descents), of(counts.entries), of(counts.bytes()),
            of(counts.bytes()) * rays_per_image / (1e6 * median(result.trace_ms))};
}

// The time of the passes that the rival replaces.
double ranges_and_trace_ms(const RenderResult& result) {
    double sum = 0;
    for (const PassSum& pass : result.passes)
        if (pass.name == "tile ranges" || pass.name == "trace") sum += median(pass.ms);
    return sum;
}

void print(const RenderResult& result, const gpu::Device& device, const RenderOptions& options,
           const voctree::VOctree& tree) {
    const auto rays = static_cast<double>(result.rays);
    fmt::print("{}: {}, {} leaves, degree {}; {} pixels, {} views, {:.0f} % of the pixels covered\n",
               device.summary().name, options.scene, tree.leaf_count, tree.hh_degree, options.size, options.views,
               100 * result.covered);
    fmt::print("{:<42} {:>9} {:>9} {:>8} {:>7}\n", "", "ms (p50)", "p99", "Mrays/s", "times");
    const double paper = result.paths[0].seconds(1);
    const auto line = [&](const std::string& name, double seconds, double p99) {
        fmt::print("{:<42} {:>9} {:>9} {:>8.2f} {:>7.1f}\n", name, ms_text(1000 * seconds), ms_text(p99),
                   rays / seconds / 1e6, paper / seconds);
    };
    for (const Path& path : result.paths) line(path.name, path.seconds(1), path.p99_ms(1));
    const Path& shaded = result.paths.back();
    line("playing at 25 fps on 2 x 90 Hz", shaded.seconds(1 / kViewsPerSlice), shaded.p99_ms(1 / kViewsPerSlice));
    fmt::print("passes of the shaded image: {} ms\n", passes_text(result.passes));
    fmt::print(
        "the same rays by C++ on {} threads: {:.1f} ms, {:.2f} times the device's {} ms (they differ by {:.1e})\n",
        std::thread::hardware_concurrency(), median(result.host.ms), median(result.host.ms) / median(result.trace_ms),
        ms_text(median(result.trace_ms)), result.host.worst_difference);
    const RayWork work = work_of(result);
    fmt::print(
        "a ray of a tile that sees anything enters {:.1f} nodes by {:.1f} descents and reads {:.1f} entries, {:.0f} "
        "bytes: "
        "{:.1f} GB/s, {:.0f} % of a copy's {:.1f}\n",
        work.nodes, work.descents, work.entries, work.bytes, work.gb_s, 100 * work.gb_s / result.copy_gb_s,
        result.copy_gb_s);
    fmt::print("shaded against the paper's: {:.3f}/255 apart in the mean, PSNR {:.1f} dB\n",
               result.differences.mean_of_255(), result.differences.psnr());
    if (!options.rival.empty()) fmt::print("{}\n", rival_text(result.rival, ranges_and_trace_ms(result)));
}

nlohmann::ordered_json json_of(const RenderResult& result, const RenderOptions& options) {
    auto paths = nlohmann::ordered_json::object();
    const double paper = result.paths[0].seconds(1);
    for (const Path& path : result.paths)
        paths[path.key] = {{"slice_ms", median(path.slice_ms)},
                           {"rest_ms", median(path.rest_ms)},
                           {"p99_ms", path.p99_ms(1)},
                           {"mrays_per_second", static_cast<double>(result.rays) / path.seconds(1) / 1e6},
                           {"times_paper", paper / path.seconds(1)}};
    const double playing = result.paths.back().seconds(1 / kViewsPerSlice);
    const RayWork work = work_of(result);
    nlohmann::ordered_json json = {{"views", options.views},
                                   {"covered", result.covered},
                                   {"ways", paths},
                                   {"playing", {{"ms", 1000 * playing}, {"times_paper", paper / playing}}},
                                   {"shaded_passes_ms", passes_json(result.passes)},
                                   {"host_rays_ms", median(result.host.ms)},
                                   {"device_rays_ms", median(result.trace_ms)},
                                   {"host_difference", result.host.worst_difference},
                                   {"nodes_a_ray", work.nodes},
                                   {"entries_a_ray", work.entries},
                                   {"bytes_a_ray", work.bytes},
                                   {"trace_gb_s", work.gb_s},
                                   {"copy_gb_s", result.copy_gb_s},
                                   {"mean_difference_of_255", result.differences.mean_of_255()},
                                   {"psnr_db", result.differences.psnr()}};
    if (!options.rival.empty()) json["rival"] = rival_json(result.rival, ranges_and_trace_ms(result));
    return json;
}

void run_render(const RenderOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::VOctree tree =
        voctree::read_clip(options.scene);  // the paths that it is compared with take linear light
    const gpu::Device device(common.device);
    const RenderResult result = measure_all(device, tree, options);
    expect_not_stopped();
    report(options, device, json_of(result, options), [&] { print(result, device, options, tree); });
}

}  // namespace

void add_render(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] =
        add_verb(app, common,
                 {"render",
                  "Images of a scene, the paper's way and ours",
                  "Renders the same views by each path of the renderer and by plain C++, and prints the GPU "
                  "time of an image,\nits slice included but not its way to the host, its ratio to the paper's path "
                  "and what the "
                  "images differ by. ",
                  {"work/performer.nvv --views 2", "work/performer.nvv --views 2 --rival raster"}},
                 run_render);
    add_size_option(verb, options);
    add_views_option(verb, options);
    add_repeats_option(verb, options, "Images of each view that the medians are over");
    verb.add_option("--rival", options.rival,
                    "Also by another renderer: `raster` projects leaves, sorts and composites them")
        .one_of({"raster"});
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

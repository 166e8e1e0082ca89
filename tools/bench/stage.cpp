// neuvv-bench stage: the cost of lights, shadows, blending and copies on a stage of two performers and a floor.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "render/clips/stage_renderer.h"
#include "tools/bench/measure.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/results.h"

namespace neuvv::bench {

namespace {

struct StageOptions : BenchOptions {
    StageOptions() { repeats = 15; }
    uint32_t copies = 32;
    bool together = false;
};

// Settings of the stage, and the time of each of its images.
struct StageVariant {
    std::string name;
    bool shadows = true, falloff = true;
    stage::StageBlend blend = stage::StageBlend::kExact;
    std::vector<double> ms;
};

// Performers beside each other, or overlapping.
stage::Stage make_bench_stage(const StageOptions& options, uint32_t performers) {
    return stage_of_copies(options.scene, performers, options.together ? 0.25 : 1.1);
}

stage::Camera bench_camera(const stage::Stage& stage, const StageOptions& options, double distance_m) {
    const media::ImageSize size = tools::parse_size(options.size);
    stage::Camera camera = stage::camera_of(stage, "camera", stage::stage_at(stage, 0), size.width, size.height);
    camera.world_from_camera[3] = glm::dvec4(0, 1.6, distance_m, 1);
    return camera;
}

// Draws an image; returns its milliseconds by the host's clock (Commands::milliseconds). Its slices are in the cache
// already where they fit the budget.
double draw(render::StageRenderer& renderer, stage::Stage& stage, const stage::Camera& camera, StageVariant& variant,
            media::Image& image) {
    stage.settings.shadows = variant.shadows;
    stage.settings.falloff = variant.falloff;
    stage.settings.blend = variant.blend;
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0);
    renderer.show(evaluated);
    image = renderer.frames().render(camera, renderer.settings_at(evaluated));
    return renderer.frames().milliseconds();
}

struct StageResult {
    std::vector<StageVariant> variants;
    uint64_t one_bytes = 0, all_bytes = 0;  // buffers of a stage with one performer, and with all copies
    media::Image image;
};

// The variants take turns, so that whatever else the machine does slows all of them alike.
std::vector<StageVariant> measure_variants(const gpu::Device& device, const StageOptions& options,
                                           media::Image& image) {
    stage::Stage stage = make_bench_stage(options, 2);
    render::StageRenderer renderer(device, stage, render::StageLoader(device).load(stage), capacity_of(options));
    const stage::Camera camera = bench_camera(stage, options, 4);
    std::vector<StageVariant> variants = {{"plain", false, false},
                                          {"shadows", true, false},
                                          {"falloff", false, true},
                                          {"shadows and falloff"},
                                          {"as layers (paper)", true, true, stage::StageBlend::kPaper}};
    tools::Progress progress("bench", options.repeats);
    for (uint32_t i = 0; i <= options.repeats && !stop_requested(); ++i) {
        for (StageVariant& variant : variants) {
            media::Image drawn;
            const double ms = draw(renderer, stage, camera, variant, drawn);
            if (variant.shadows && variant.falloff && variant.blend == stage::StageBlend::kExact) image = drawn;
            if (i == 0) continue;  // the first round builds slices and pipelines
            variant.ms.push_back(ms);
        }
        progress.update(i);
    }
    return variants;
}

// Bytes of the buffers of a stage with so many copies, each at its own time, after an image of it.
uint64_t bytes_with(const gpu::Device& device, const StageOptions& options, uint32_t copies) {
    const uint64_t before = device.buffer_bytes();
    stage::Stage stage = make_bench_stage(options, copies);
    render::StageRenderer renderer(device, stage, render::StageLoader(device).load(stage), capacity_of(options));
    StageVariant variant;
    media::Image image;
    draw(renderer, stage, bench_camera(stage, options, 4.0 + copies), variant, image);
    return device.buffer_bytes() - before;
}

double growth(const StageResult& result, size_t variant) {
    return median(result.variants[variant].ms) / median(result.variants[0].ms) - 1;
}

void print(const StageResult& result, const gpu::Device& device, const StageOptions& options) {
    fmt::print("{}: {}, {}, two performers {}, a floor, a spotlight\n", device.summary().name, options.scene,
               options.size, options.together ? "in each other" : "beside each other");
    for (size_t i = 0; i < result.variants.size(); ++i) {
        const StageVariant& variant = result.variants[i];
        fmt::print("{:<20} {:>8.1f} ms  {:>+6.1f} %\n", variant.name, median(variant.ms), 100 * growth(result, i));
    }
    fmt::print("{} copies: {:.1f} MiB of buffers, {:.4f} times those of one\n", options.copies,
               static_cast<double>(result.all_bytes) / 1048576,
               static_cast<double>(result.all_bytes) / static_cast<double>(result.one_bytes));
}

nlohmann::ordered_json json_of(const StageResult& result, const StageOptions& options) {
    nlohmann::ordered_json json;
    for (size_t i = 0; i < result.variants.size(); ++i)
        json["ways"].push_back(
            {{"name", result.variants[i].name}, {"ms", median(result.variants[i].ms)}, {"growth", growth(result, i)}});
    json["copies"] = options.copies;
    json["one_bytes"] = result.one_bytes;
    json["all_bytes"] = result.all_bytes;
    return json;
}

void run_stage(const StageOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    if (!options.image.empty()) tools::prepare_result("--image", options.image, {".png"});
    const gpu::Device device(common.device);
    StageResult result;
    result.variants = measure_variants(device, options, result.image);
    expect_not_stopped();
    result.one_bytes = bytes_with(device, options, 1);
    result.all_bytes = bytes_with(device, options, options.copies);
    expect_not_stopped();
    if (!options.image.empty()) media::write_png(options.image, result.image);
    report(options, device, json_of(result, options), [&] { print(result, device, options); });
}

}  // namespace

void add_stage(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(
        app, common,
        {"stage",
         "Lights, shadows, blending and copies on a stage",
         "Draws two performers on a floor under a spotlight with and without its shadow and falloff, all slices "
         "there already, and prints the time of an image; then device memory of copies.\n",
         {"work/performer.nvv", "work/performer.nvv --together --repeats 5"}},
        run_stage);
    add_size_option(verb, options);
    verb.add_flag("--together", options.together, "The performers stand in each other");
    verb.add_option("--copies", options.copies, "Performers of the stage whose memory is held against one's")
        .in_range(1u, render::kMaxInstances)
        .show_default();
    tools::add_slice_budget_option(verb, options.slice_budget_mb);
    add_repeats_option(verb, options, "Images of each variant that the medians are over");
    add_image_option(verb, options);
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

// neuvv-bench far: what coarser levels are worth where performers are far away: how near images of one ray a pixel come
// to those of 64, how much they flicker as the camera moves, and how long a crowd takes.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "render/volume/field_levels.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "training/evaluation/metrics.h"
#include "voctree/files/clip.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::bench {

namespace {

struct FarOptions : BenchOptions {
    uint32_t count = 64;
    FarOptions() { size = "160x160"; }
};

constexpr uint32_t kTruthSamples = 8;  // along each side of a pixel
constexpr uint32_t kDivisors[] = {1, 2, 4, 8};
constexpr int kSteps = 24;  // of a moving camera

// One way to draw: all of the field, its levels, or the truth.
struct Way {
    uint32_t samples = 1;
    bool far_levels = false;
};
constexpr Way kWithout{1, false}, kWith{1, true}, kTruth{kTruthSamples, false};

// Images of a clip that get smaller, at which one camera looks.
struct Scene {
    Scene(const gpu::Device& device, const voctree::VOctree& tree, render::Field with_levels, const FarOptions& options)
        : box(voctree::occupied_box(tree)),
          frames(tree.frames),
          size(tools::parse_size(options.size)),
          field(std::move(with_levels)),
          renderer(device, field, capacity_of(options)) {
        render::FrameCapacity capacity = capacity_of(options);
        capacity.samples = kTruthSamples;
        truth = std::make_unique<render::FrameRenderer>(device, field, capacity);
    }

    // A camera at `angle` around the performer and `away` times its size from it, for an image so many times smaller.
    stage::Camera camera(uint32_t divisor, double angle, double away = 2.2) const {
        const double size_m = glm::length(box.second - box.first);
        const glm::dmat4 turned =
            glm::rotate(glm::translate(glm::dmat4(1), 0.5 * (box.first + box.second)), angle, glm::dvec3(0, 1, 0));
        const media::ImageSize smaller{std::max(size.width / divisor, 1u), std::max(size.height / divisor, 1u)};
        return tools::centred_camera(smaller, 2.0 * std::min(smaller.width, smaller.height),
                                     glm::translate(turned, glm::dvec3(0, 0, away * size_m)));
    }
    media::Image image(const stage::Camera& camera, Way way, double frame) {
        render::FrameSettings settings = play_settings({camera.width, camera.height});
        settings.instances[0].frame = static_cast<float>(frame);
        settings.samples = way.samples;
        settings.far_levels = way.far_levels;
        return (way.samples > 1 ? *truth : renderer).render(camera, settings);
    }

    std::pair<glm::dvec3, glm::dvec3> box;
    uint32_t frames;
    media::ImageSize size;
    render::Field field;
    render::FrameRenderer renderer;
    std::unique_ptr<render::FrameRenderer> truth;
};

double mean_difference(const media::Image& a, const media::Image& b) {
    return 255 * training::compare(a, b).mae;
}

// Of images so many times smaller than --size; each pair is without and with coarser levels.
struct Footprint {
    uint32_t divisor = 1, level = 0;  // the level of the last view
    double psnr[2] = {}, ssim[2] = {};
    double flicker[2] = {};  // of 255: difference of successive images, less that of the truth
};

Footprint measure_footprint(Scene& scene, uint32_t divisor, uint32_t views) {
    Footprint result{divisor};
    for (uint32_t view = 0; view < views; ++view) {
        const stage::Camera camera = scene.camera(divisor, 0.2 + 1.3 * view);
        const double frame = (scene.frames - 1.0) * view / std::max(views - 1, 1u);
        const media::Image truth = scene.image(camera, kTruth, frame);
        for (const int with : {0, 1}) {
            const training::Quality quality =
                training::compare(truth, scene.image(camera, with ? kWith : kWithout, frame));
            result.psnr[with] += quality.psnr / views;
            result.ssim[with] += quality.ssim / views;
        }
        result.level = render::far_level_for(scene.field, {&camera, 1}, glm::mat4(1), 1);
    }
    double moved[3] = {};  // without, with, truth
    media::Image last[3];
    for (int step = 0; step < kSteps; ++step) {
        const stage::Camera camera = scene.camera(divisor, 0.2 + 0.01 * step);
        for (int way = 0; way < 3; ++way) {
            const media::Image image = scene.image(camera, way == 0 ? kWithout : way == 1 ? kWith : kTruth, 0);
            if (step > 0) moved[way] += mean_difference(last[way], image) / (kSteps - 1);
            last[way] = image;
        }
    }
    for (const int with : {0, 1}) result.flicker[with] = moved[with] - moved[2];
    return result;
}

// A camera that moves away until the performer is an eighth as large: differences of successive images, of 255.
struct Switches {
    std::vector<double> at_switch, between, truth_at_switch;
};

Switches measure_switches(Scene& scene) {
    constexpr int kAway = 120;
    Switches result;
    media::Image last, last_truth;
    uint32_t last_level = 0;
    for (int step = 0; step < kAway; ++step) {
        const stage::Camera camera = scene.camera(1, 0.2, 2.2 * std::exp2(3.0 * step / (kAway - 1)));
        const uint32_t level = render::far_level_for(scene.field, {&camera, 1}, glm::mat4(1), 1);
        const media::Image image = scene.image(camera, kWith, 0), truth = scene.image(camera, kTruth, 0);
        if (step > 0) (level != last_level ? result.at_switch : result.between).push_back(mean_difference(last, image));
        if (step > 0 && level != last_level) result.truth_at_switch.push_back(mean_difference(last_truth, truth));
        last = image;
        last_truth = truth;
        last_level = level;
    }
    return result;
}

// Milliseconds of an image of copies in a square, each at its own time, as large as --size an eighth each; slices are
// built anew for each image, as while a clip plays.
std::vector<double> crowd_ms(Scene& scene, const FarOptions& options, bool far_levels) {
    const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(options.count)));
    const double step_m = glm::length(scene.box.second - scene.box.first);
    stage::Camera camera = scene.camera(1, 0, 2.2 * 8);
    camera.world_from_camera[3] += glm::dvec4(0.5 * step_m * (side - 1), 0.5 * step_m * (side - 1), 0, 0);
    render::FrameSettings settings = play_settings({camera.width, camera.height});
    settings.far_levels = far_levels;
    settings.instances.clear();
    for (uint32_t i = 0; i < options.count; ++i) {
        const glm::dvec3 at(step_m * (i % side), step_m * std::floor(i / side), 0);
        settings.instances.push_back(
            {static_cast<float>(i % scene.frames), glm::mat4(glm::translate(glm::dmat4(1), at))});
    }
    scene.renderer.render(camera, settings);  // compiles pipelines
    std::vector<double> ms;
    for (uint32_t i = 0; i < options.repeats && !stop_requested(); ++i) {
        scene.renderer.forget_slices();
        scene.renderer.render(camera, settings);
        ms.push_back(scene.renderer.milliseconds());
    }
    return ms;
}

struct FarResult {
    std::vector<Footprint> footprints;
    Switches switches;
    std::vector<double> crowd[2];
    double upload_ms[2] = {};      // the field alone, with its levels
    uint64_t bytes[2] = {};        // on the device, likewise
    std::vector<uint32_t> leaves;  // of each level
};

FarResult measure(const gpu::Device& device, const voctree::VOctree& tree, const FarOptions& options) {
    FarResult result;
    render::Field field;
    for (const int with : {0, 1}) {
        field = {};  // frees the memory of the one before
        const uint64_t before = device.buffer_bytes();
        const auto start = std::chrono::steady_clock::now();
        field = with ? render::upload_far_levels(device, tree)
                     : render::upload_field(device, tree, render::WeightPrecision::kHalf);
        result.upload_ms[with] = milliseconds_since(start);
        result.bytes[with] = device.buffer_bytes() - before;
        if (!with) continue;
        result.leaves.push_back(field.leaf_count);
        for (const render::Field& coarser : field.coarser) result.leaves.push_back(coarser.leaf_count);
    }
    Scene scene(device, tree, std::move(field), options);
    for (const uint32_t divisor : kDivisors)
        result.footprints.push_back(measure_footprint(scene, divisor, options.views));
    result.switches = measure_switches(scene);
    for (const int with : {0, 1}) result.crowd[with] = crowd_ms(scene, options, with == 1);
    return result;
}

void print(const FarResult& result, const gpu::Device& device, const FarOptions& options) {
    fmt::print("{}: {}, {}; levels of {} leaves\n", device.summary().name, options.scene, options.size,
               fmt::join(result.leaves, ", "));
    fmt::print("{:<10} {:>6} {:>18} {:>20} {:>22}\n", "image", "level", "PSNR, dB", "SSIM", "flicker of 255");
    for (const Footprint& one : result.footprints)
        fmt::print("{:<10} {:>6} {:>8.2f} {:>9.2f} {:>10.4f} {:>9.4f} {:>11.3f} {:>10.3f}\n",
                   fmt::format("1/{}", one.divisor), one.level, one.psnr[0], one.psnr[1], one.ssim[0], one.ssim[1],
                   one.flicker[0], one.flicker[1]);
    const auto worst = [](const std::vector<double>& values) { return quantile(values, 1); };
    fmt::print(
        "moving away: a step changes {:.3f} of 255 (median; at most {:.3f}), a step with a switch {:.3f} (at most "
        "{:.3f}; 64 rays a pixel {:.3f})\n",
        median(result.switches.between), worst(result.switches.between), median(result.switches.at_switch),
        worst(result.switches.at_switch), worst(result.switches.truth_at_switch));
    fmt::print("{} performers: {:.1f} ms without, {:.1f} ms with coarser levels\n", options.count,
               median(result.crowd[0]), median(result.crowd[1]));
    fmt::print("upload: {:.0f} ms, with levels {:.0f} ms; {:.1f} MiB, with levels {:.1f} MiB\n", result.upload_ms[0],
               result.upload_ms[1], static_cast<double>(result.bytes[0]) / 1048576,
               static_cast<double>(result.bytes[1]) / 1048576);
}

nlohmann::ordered_json json_of(const FarResult& result, const FarOptions& options) {
    nlohmann::ordered_json footprints = nlohmann::ordered_json::array();
    for (const Footprint& one : result.footprints)
        footprints.push_back({{"divisor", one.divisor},
                              {"level", one.level},
                              {"psnr", one.psnr},
                              {"ssim", one.ssim},
                              {"flicker_of_255", one.flicker}});
    return {{"leaves", result.leaves},
            {"footprints", footprints},
            {"step_of_255", median(result.switches.between)},
            {"switch_of_255", result.switches.at_switch},
            {"count", options.count},
            {"crowd_ms", {median(result.crowd[0]), median(result.crowd[1])}},
            {"upload_ms", result.upload_ms},
            {"bytes", result.bytes}};
}

void run_far(const FarOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const voctree::VOctree tree = voctree::read_clip(options.scene, voctree::PlenoctreeColours::kAsStored);
    const gpu::Device device(common.device);
    const FarResult result = measure(device, tree, options);
    expect_not_stopped();
    report(options, device, json_of(result, options), [&] { print(result, device, options); });
}

}  // namespace

void add_far(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(
        app, common,
        {"far",
         "Performers that are far away, without and with coarser levels",
         "Draws images of --size, of a half, a quarter and an eighth with one ray a pixel, without and with coarser "
         "levels, and prints how near they come to 64 rays a pixel, how much more they change than those as the camera "
         "turns, what a switch of levels changes, and the time of a crowd, whose slices are built for each image.\n",
         {"work/performer.nvv", "work/performer.nvv --size 480x480 --count 16"}},
        run_far);
    verb.add_option("--count", options.count, "Performers of the crowd")
        .in_range(1u, render::kMaxInstances)
        .show_default();
    tools::add_slice_budget_option(verb, options.slice_budget_mb);
    add_size_option(verb, options, "WIDTHxHEIGHT of the largest images: those that the clip was trained on");
    add_views_option(verb, options);
    add_repeats_option(verb, options, "Images of the crowd that the median is of");
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

// neuvv-bench instances: compares copies of a performer with a single one, in memory and in time per covered ray.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/view_path.h"
#include "voctree/files/clip.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::bench {

namespace {

struct InstancesOptions : BenchOptions {
    uint32_t count = 16;
};

struct Drawn {
    media::Image image;  // the last one
    std::vector<PassSum> passes;
    std::vector<double> ms;     // of each image, with its slices in the cache
    uint64_t buffer_bytes = 0;  // of renderer and performer, on the device
    uint64_t covered = 0;       // rays in all frames
    uint32_t slices = 0;        // instances that have a slice
};

// Copies side by side in a square that faces the camera, each with its own rotation and time.
std::vector<render::Instance> copies_of(const voctree::VOctree& tree, const std::pair<glm::dvec3, glm::dvec3>& box,
                                        uint32_t count) {
    const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(count)));
    const glm::dvec3 centre = 0.5 * (box.first + box.second);
    const double step_m = 1.05 * glm::length(box.second - box.first);
    std::vector<render::Instance> copies;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::dvec2 cell = glm::dvec2(i % side, i / side) - 0.5 * (side - 1.0);
        glm::dmat4 transform = glm::translate(glm::dmat4(1), glm::dvec3(cell.x * step_m, cell.y * step_m, 0) + centre);
        transform = glm::rotate(transform, 2.4 * i, glm::dvec3(0, 1, 0));
        const double time = (tree.frames - 1.0) * i / std::max(count - 1, 1u);
        copies.push_back({static_cast<float>(time), glm::mat4(glm::translate(transform, -centre))});
    }
    return copies;
}

// A camera that sees a square of `count` copies from +Z.
stage::Camera camera_of(const std::pair<glm::dvec3, glm::dvec3>& box, uint32_t count, media::ImageSize size) {
    const glm::dvec3 centre = 0.5 * (box.first + box.second);
    const double radius_m = 0.55 * std::ceil(std::sqrt(count)) * glm::length(box.second - box.first);
    return tools::centred_camera(size, 1.2 * std::min(size.width, size.height),
                                 glm::translate(glm::dmat4(1), centre + glm::dvec3(0, 0, 2.6 * radius_m)));
}

// Draws frames of so many instances each, one after the other.
Drawn draw(const gpu::Device& device, const render::Field& field, const InstancesOptions& options,
           const stage::Camera& camera, const std::vector<std::vector<render::Instance>>& frames) {
    const uint64_t before = device.buffer_bytes();
    render::FrameRenderer renderer(device, field, capacity_of(options));
    render::FrameSettings settings = play_settings({camera.width, camera.height});
    Drawn drawn;
    for (const std::vector<render::Instance>& instances : frames) {
        settings.instances = instances;
        renderer.render(camera, settings);  // builds slices, compiles pipelines
        for (uint32_t i = 0; i < options.repeats && !stop_requested(); ++i) {
            drawn.image = renderer.render(camera, settings);
            drawn.ms.push_back(milliseconds(renderer.pass_times()));
            add_image(drawn.passes, renderer.pass_times());
        }
        drawn.covered += covered_rays(renderer.radiance());
        if (const render::SliceCache* slices = renderer.slices().performer()->slices())
            for (const render::Instance& instance : instances)
                drawn.slices += slices->find({instance.frame, instance.paint}).has_value();
    }
    drawn.buffer_bytes = device.buffer_bytes() - before;
    return drawn;
}

struct InstancesResult {
    Drawn one, all;  // `one`: each copy alone
    uint32_t count = 1;
    uint64_t field_bytes = 0;
    double growth_of_rays() const {
        return count * static_cast<double>(all.covered) / static_cast<double>(std::max<uint64_t>(one.covered, 1));
    }
    double growth_of_time() const { return mean(all.ms) / mean(one.ms); }
    double memory_ratio() const {
        return static_cast<double>(all.buffer_bytes + field_bytes) /
               static_cast<double>(one.buffer_bytes + field_bytes);
    }
};

InstancesResult measure_all(const gpu::Device& device, const voctree::VOctree& tree, const InstancesOptions& options) {
    const uint64_t before = device.buffer_bytes();
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    InstancesResult result;
    result.field_bytes = device.buffer_bytes() - before;
    const auto box = voctree::occupied_box(tree);
    const std::vector<render::Instance> copies = copies_of(tree, box, options.count);
    const stage::Camera camera = camera_of(box, options.count, tools::parse_size(options.size));
    tools::Progress progress("bench", 2);
    result.count = options.count;
    std::vector<std::vector<render::Instance>> alone;
    for (const render::Instance& copy : copies) alone.push_back({copy});
    result.one = draw(device, field, options, camera, alone);
    progress.update(1);
    result.all = draw(device, field, options, camera, {copies});
    progress.update(2);
    return result;
}

void print(const InstancesResult& result, const gpu::Device& device, const InstancesOptions& options) {
    fmt::print("{}: {}, {}, slices of at most {:.0f} MiB\n", device.summary().name, options.scene, options.size,
               options.slice_budget_mb);
    fmt::print("{:<18} {:>10} {:>14} {:>16} {:>14}\n", "instances", "ms (mean)", "covered rays", "with a slice", "MiB");
    const auto line = [&](const std::string& count, const Drawn& drawn, uint32_t frames) {
        fmt::print("{:<18} {:>10} {:>14} {:>16} {:>14.1f}\n", count, ms_text(mean(drawn.ms)), drawn.covered / frames,
                   drawn.slices, static_cast<double>(drawn.buffer_bytes + result.field_bytes) / 1048576);
        fmt::print("    {} ms\n", passes_text(drawn.passes));
    };
    line("1 (each of them)", result.one, options.count);
    line(fmt::format("{}", options.count), result.all, 1);
    fmt::print("time grows {:.2f} times as much as covered rays; memory is {:.4f} times that of one, {:.2f} MiB more\n",
               result.growth_of_time() / result.growth_of_rays(), result.memory_ratio(),
               (static_cast<double>(result.all.buffer_bytes) - static_cast<double>(result.one.buffer_bytes)) / 1048576);
}

nlohmann::ordered_json json_of(const InstancesResult& result, const InstancesOptions& options) {
    const auto drawn_json = [&](const Drawn& drawn, uint32_t frames) {
        return nlohmann::ordered_json{{"ms", mean(drawn.ms)},
                                      {"covered_rays", drawn.covered / frames},
                                      {"with_a_slice", drawn.slices},
                                      {"bytes", drawn.buffer_bytes + result.field_bytes}};
    };
    return {{"count", options.count},
            {"slice_budget_mb", options.slice_budget_mb},
            {"one", drawn_json(result.one, options.count)},
            {"all", drawn_json(result.all, 1)},
            {"time_by_rays", result.growth_of_time() / result.growth_of_rays()},
            {"memory_ratio", result.memory_ratio()}};
}

void run_instances(const InstancesOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    if (!options.image.empty()) tools::prepare_result("--image", options.image, {".png"});
    const voctree::VOctree tree = voctree::read_clip(options.scene, voctree::PlenoctreeColours::kAsStored);
    const gpu::Device device(common.device);
    const InstancesResult result = measure_all(device, tree, options);
    expect_not_stopped();
    if (!options.image.empty()) media::write_png(options.image, result.all.image);
    report(options, device, json_of(result, options), [&] { print(result, device, options); });
}

}  // namespace

void add_instances(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(
        app, common,
        {"instances",
         "Copies of a performer, each with its own position and time",
         "Draws each copy alone and then all of them, as large, with the slices already there, and prints GPU time, "
         "covered rays and device memory of both.\n",
         {"work/performer.nvv", "work/performer.nvv --count 32 --slice-budget 0"}},
        run_instances);
    verb.add_option("--count", options.count, "Copies, each turned and at its own time")
        .in_range(2u, render::kMaxInstances)
        .show_default();
    tools::add_slice_budget_option(verb, options.slice_budget_mb);
    add_size_option(verb, options);
    add_repeats_option(verb, options, "Images of each that the means are over");
    add_image_option(verb, options);
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

// neuvv-bench instances: copies of one performer against one of them, in memory and in time for what is covered.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "tools/bench/measure.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "voctree/nvv.h"

namespace neuvv::bench {

namespace {

struct InstancesOptions : BenchOptions {
    uint32_t count = 16;
};

struct Shown {
    media::Image image;  // the last
    std::vector<PassSum> passes;
    std::vector<double> ms;     // with slices resident
    uint64_t buffer_bytes = 0;  // of renderer and performer on the device
    uint64_t covered = 0;       // rays of all frames
    uint32_t slices = 0;        // of instances that have one
};

// Copies side by side in a square that faces the camera, each turned and at its own time.
std::vector<render::Instance> copies_of(const voctree::VOctree& tree, const std::pair<glm::dvec3, glm::dvec3>& box,
                                        uint32_t count) {
    const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(count)));
    const glm::dvec3 middle = 0.5 * (box.first + box.second);
    const double step_m = 1.05 * glm::length(box.second - box.first);
    std::vector<render::Instance> copies;
    for (uint32_t i = 0; i < count; i++) {
        const glm::dvec2 cell = glm::dvec2(i % side, i / side) - 0.5 * (side - 1.0);
        glm::dmat4 place = glm::translate(glm::dmat4(1), glm::dvec3(cell.x * step_m, cell.y * step_m, 0) + middle);
        place = glm::rotate(place, 2.4 * i, glm::dvec3(0, 1, 0));
        const double time = (tree.frames - 1.0) * i / std::max(count - 1, 1u);
        copies.push_back({static_cast<float>(time), glm::mat4(glm::translate(place, -middle))});
    }
    return copies;
}

// Sees a square of `count` copies from +Z.
stage::Camera camera_of(const std::pair<glm::dvec3, glm::dvec3>& box, uint32_t count, media::ImageSize size) {
    const glm::dvec3 middle = 0.5 * (box.first + box.second);
    const double radius_m = 0.55 * std::ceil(std::sqrt(count)) * glm::length(box.second - box.first);
    return tools::centred_camera(size, 1.2 * std::min(size.width, size.height),
                                 glm::translate(glm::dmat4(1), middle + glm::dvec3(0, 0, 2.6 * radius_m)));
}

// Draws frames of so many instances each, one after the other.
Shown show(const gpu::Device& device, const render::Field& field, const InstancesOptions& options,
           const stage::Camera& camera, const std::vector<std::vector<render::Instance>>& frames) {
    const uint64_t before = device.buffer_bytes();
    render::FrameRenderer renderer(device, field, capacity_of(options));
    render::FrameSettings settings = play_settings({camera.width, camera.height});
    Shown shown;
    for (const std::vector<render::Instance>& instances : frames) {
        settings.instances = instances;
        renderer.render(camera, settings);  // slices, compiles
        for (uint32_t i = 0; i < options.repeats && !stop_requested(); i++) {
            shown.image = renderer.render(camera, settings);
            shown.ms.push_back(milliseconds(renderer.pass_times()));
            add_image(shown.passes, renderer.pass_times());
        }
        shown.covered += covered_rays(renderer.radiance());
        if (const render::SliceCache* slices = renderer.performer()->slices())
            for (const render::Instance& instance : instances)
                shown.slices += slices->find({instance.frame, instance.paint}).has_value();
    }
    shown.buffer_bytes = device.buffer_bytes() - before;
    return shown;
}

struct Result {
    Shown one, all;  // one: each alone
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

Result measure_all(const gpu::Device& device, const voctree::VOctree& tree, const InstancesOptions& options) {
    const uint64_t before = device.buffer_bytes();
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    Result result;
    result.field_bytes = device.buffer_bytes() - before;
    const auto box = tools::occupied_box(tree);
    const std::vector<render::Instance> copies = copies_of(tree, box, options.count);
    const stage::Camera camera = camera_of(box, options.count, tools::parse_size(options.size));
    tools::Progress progress("bench", 2);
    result.count = options.count;
    std::vector<std::vector<render::Instance>> alone;
    for (const render::Instance& copy : copies) alone.push_back({copy});
    result.one = show(device, field, options, camera, alone);
    progress.update(1);
    result.all = show(device, field, options, camera, {copies});
    progress.update(2);
    return result;
}

void print(const Result& result, const gpu::Device& device, const InstancesOptions& options) {
    fmt::print("{}: {}, {}, slices of at most {:.0f} MiB\n", device.summary().name, options.scene, options.size,
               options.slice_budget_mb);
    fmt::print("{:<18} {:>10} {:>14} {:>16} {:>14}\n", "instances", "ms (mean)", "covered rays", "with a slice", "MiB");
    const auto line = [&](const std::string& count, const Shown& shown, uint32_t frames) {
        fmt::print("{:<18} {:>10.1f} {:>14} {:>16} {:>14.1f}\n", count, mean(shown.ms), shown.covered / frames,
                   shown.slices, static_cast<double>(shown.buffer_bytes + result.field_bytes) / 1048576);
        fmt::print("    {} ms\n", passes_text(shown.passes));
    };
    line("1 (each of them)", result.one, options.count);
    line(fmt::format("{}", options.count), result.all, 1);
    fmt::print("time grows {:.2f} times as much as covered rays; memory is {:.4f} times that of one, {:.2f} MiB more\n",
               result.growth_of_time() / result.growth_of_rays(), result.memory_ratio(),
               (static_cast<double>(result.all.buffer_bytes) - static_cast<double>(result.one.buffer_bytes)) / 1048576);
}

nlohmann::ordered_json json_of(const Result& result, const InstancesOptions& options) {
    const auto shown = [&](const Shown& one, uint32_t frames) {
        return nlohmann::ordered_json{{"ms", mean(one.ms)},
                                      {"covered_rays", one.covered / frames},
                                      {"with_a_slice", one.slices},
                                      {"bytes", one.buffer_bytes + result.field_bytes}};
    };
    return {{"count", options.count},
            {"slice_budget_mb", options.slice_budget_mb},
            {"one", shown(result.one, options.count)},
            {"all", shown(result.all, 1)},
            {"time_by_rays", result.growth_of_time() / result.growth_of_rays()},
            {"memory_ratio", result.memory_ratio()}};
}

void run(const InstancesOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    if (!options.image.empty()) tools::prepare_output_file("--picture", options.image);
    const voctree::VOctree tree = voctree::read_nvv(options.scene);
    const gpu::Device device(common.device);
    const Result result = measure_all(device, tree, options);
    expect_not_stopped();
    if (!options.image.empty()) media::write_png(options.image, result.all.image);
    report(options, device, json_of(result, options), [&] { print(result, device, options); });
}

}  // namespace

void add_instances(CLI::App& app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(
        app, common,
        {"instances",
         "Copies of a performer, each at its own place and time",
         "Draws each copy alone and then all of them, as large, with the slices already there, and prints GPU time, "
         "covered rays and device memory of both.\n",
         {"build/performer.nvv", "build/performer.nvv --count 32 --slice-budget 0"}},
        run);
    verb->add_option("--count", options.count, "Copies, each turned and at its own time")
        ->check(CLI::Range(2u, render::kMaxInstances))
        ->capture_default_str();
    tools::add_slice_budget_option(*verb, options.slice_budget_mb);
    add_size_option(*verb, options);
    add_repeats_option(*verb, options, "Images of each that the means are over");
    add_image_option(*verb, options);
    add_json_flag(*verb, options);
}

}  // namespace neuvv::bench

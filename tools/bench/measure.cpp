#include "tools/bench/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/platform.h"
#include "base/seconds.h"
#include "edit/operations.h"
#include "tools/options.h"
#include "tools/report.h"
#include "training/evaluation/metrics.h"
#include "voctree/files/clip.h"

#include "shared/copy.h"
#include "spirv/copy.comp.h"

namespace neuvv::bench {

tools::Command add_scene_verb(tools::Command app, const VerbHelp& help, BenchOptions& options) {
    tools::Command verb = app.add_verb(help.name, help.summary);
    verb.add_option("scene", options.scene, help.scene).required();
    std::string footer = help.explanation + tools::kDeviceHelp + tools::kExamplesHead;
    for (const std::string& example : help.examples)
        footer += fmt::format("{}  neuvv-bench {} {}", footer.ends_with('\n') ? "" : "\n", help.name, example);
    verb.footer({footer});
    return verb;
}

void add_size_option(tools::Command verb, BenchOptions& options, const char* help) {
    verb.add_option("--size", options.size, help).show_default();
}

void add_views_option(tools::Command verb, BenchOptions& options) {
    verb.add_option("--views", options.views, "Views of the orbit, as the clip plays").in_range(1, 100).show_default();
}

void add_repeats_option(tools::Command verb, BenchOptions& options, const char* help) {
    verb.add_option("--repeats", options.repeats, help).in_range(1, 10000).show_default();
}

void add_image_option(tools::Command verb, BenchOptions& options) {
    verb.add_option("--image", options.image, "Write what was drawn to this PNG");
}

void add_json_flag(tools::Command verb, BenchOptions& options) {
    verb.add_flag("--json", options.json, "Print JSON");
}

void expect_not_stopped() {
    if (stop_requested()) throw RuntimeFailure("stopped before the end");
}

void report(const BenchOptions& options, const gpu::Device& device, const nlohmann::ordered_json& facts,
            const std::function<void()>& print_table) {
    if (!options.json) {
        fmt::print("arrays in {}\n", tools::profile_text(device.buffers()));
        return print_table();
    }
    nlohmann::ordered_json json = {{"device", device.summary().name},
                                   {"buffers", tools::profile_name(device.buffers().profile)},
                                   {"scene", options.scene}};
    if (!options.size.empty()) json["size"] = options.size;
    json.update(facts);
    fmt::print("{}", json_text(json));
}

render::FrameCapacity capacity_of(const BenchOptions& options) {
    const media::ImageSize size = tools::parse_size(options.size);
    render::FrameCapacity capacity{size.width, size.height};
    capacity.slice_budget = tools::bytes_of_mebibytes(options.slice_budget_mb);
    return capacity;
}

render::FrameSettings play_settings(media::ImageSize size) {
    render::FrameSettings settings;
    settings.width = size.width;
    settings.height = size.height;
    settings.mode = render::TraceMode::kPlay;
    settings.resolve.background = {1, 1, 1, 1};
    return settings;
}

stage::Stage stage_of_copies(const std::filesystem::path& clip, uint32_t copies, double widths_apart) {
    const std::filesystem::path file_of_clip = std::filesystem::absolute(clip);
    stage::StageFile file = edit::new_stage(file_of_clip.parent_path() / "bench.gltf");
    const voctree::ClipHeader header = voctree::read_clip_header(file_of_clip);
    const double step_m = widths_apart * header.box_size.x;
    for (uint32_t i = 0; i < copies; ++i) {
        edit::Placement placement;
        placement.at = glm::dvec3(step_m * (i - 0.5 * (copies - 1)), -header.box_min.y, 0);
        edit::PerformerEdit edit;
        edit.clip = file_of_clip;
        edit.time = stage::parse_time_map(fmt::format("loop,offset:{}f", -static_cast<double>(i * (header.frames / 2))),
                                          "bench", "");
        edit::add_performer(file, fmt::format("performer {}", i), edit, placement);
    }
    return stage::make_stage(std::move(file));
}

uint64_t covered_rays(const std::vector<glm::vec4>& rays) {
    const auto covered = [](glm::vec4 ray) { return ray.a > 1.0f / 255; };
    return static_cast<uint64_t>(std::count_if(rays.begin(), rays.end(), covered));
}

double quantile(std::vector<double> values, double p) {
    if (values.empty()) return 0;
    const auto at = std::min(values.size() - 1, static_cast<size_t>(p * static_cast<double>(values.size())));
    std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(at), values.end());
    return values[at];
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

void Differences::add(const media::Image& truth, const media::Image& image) {
    const training::Quality quality = training::compare(truth, image);
    absolute.push_back(quality.mae);
    squared.push_back(std::pow(10, -quality.psnr / 10));
}

double Differences::psnr() const {
    return -10 * std::log10(std::max(mean(squared), 1e-10));
}

uint32_t warm_up(const std::function<void()>& draw) {
    const double until = seconds_now() + 1;
    uint32_t calls = 0;
    do {
        draw();
        ++calls;
    } while (seconds_now() < until && !stop_requested());
    return calls;
}

namespace {

// The median of several times that what `record` records takes on the device.
double recorded_ms(gpu::Commands& commands, const std::function<void()>& record) {
    std::vector<double> ms;
    for (int i = 0; i < 7; ++i) {
        commands.begin();
        {
            const gpu::PassScope scope(commands, "copy");
            record();
        }
        commands.submit();
        commands.wait();
        ms.push_back(commands.pass_times()[0].milliseconds);
    }
    return median(ms);
}

}  // namespace

double copied_bytes_per_second(const gpu::Device& device) {
    // Larger than any cache, but a small part of what software devices offer.
    const uint64_t bytes = std::min(
        {uint64_t{256} << 20, device.summary().memory.size / 16, uint64_t{device.limits().maxStorageBufferRange}});
    const gpu::Buffer from(device, "copy from", bytes, gpu::MemoryKind::kDevice);
    const gpu::Buffer to(device, "copy to", bytes, gpu::MemoryKind::kDevice);
    const gpu::ComputePass pass(device, "copy", copy_comp);
    const gpu::BindingSet set(pass, {{kCopyFrom, &from}, {kCopyTo, &to}});
    const CopyPush push{static_cast<uint32_t>(bytes / 16)};
    const uint32_t groups = gpu::groups_of(push.vectors, kCopyGroup * kCopyOfThread);
    gpu::Commands commands(device, "copy");
    // Memory that nothing was written to may have no pages of its own.
    gpu::run_once(device, "fill", [&](gpu::Commands& to_fill) {
        gpu::fill(to_fill, from, 1);
        gpu::fill(to_fill, to, 2);
    });
    warm_up([&] { gpu::run_once(device, "copy", [&](gpu::Commands& once) { gpu::copy(once, from, to, bytes); }); });
    const double by_driver = recorded_ms(commands, [&] { gpu::copy(commands, from, to, bytes); });
    const double by_shader = recorded_ms(commands, [&] { gpu::dispatch_groups(commands, pass, set, groups, push); });
    return 2000 * static_cast<double>(bytes) / std::min(by_driver, by_shader);
}

double milliseconds(const std::vector<gpu::PassTime>& passes) {
    double sum = 0;
    for (const gpu::PassTime& pass : passes)
        if (pass.name != kReadbackPass) sum += pass.milliseconds;
    return sum;
}

std::string ms_text(double ms) {
    return ms < 1 ? fmt::format("{:.3f}", ms) : ms < 10 ? fmt::format("{:.2f}", ms) : fmt::format("{:.1f}", ms);
}

void add_image(std::vector<PassSum>& sums, const std::vector<gpu::PassTime>& passes) {
    for (const gpu::PassTime& pass : passes) {
        auto found = std::find_if(sums.begin(), sums.end(), [&](const PassSum& sum) { return sum.name == pass.name; });
        if (found == sums.end()) found = sums.insert(sums.end(), {pass.name, {}});
        const bool again = std::find_if(passes.data(), &pass, [&](const gpu::PassTime& earlier) {
                               return earlier.name == pass.name;
                           }) != &pass;
        if (again)
            found->ms.back() += pass.milliseconds;
        else
            found->ms.push_back(pass.milliseconds);
    }
}

std::string passes_text(const std::vector<PassSum>& sums) {
    std::string text;
    for (const PassSum& sum : sums)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", sum.name, ms_text(median(sum.ms)));
    return text;
}

nlohmann::ordered_json passes_json(const std::vector<PassSum>& sums) {
    auto json = nlohmann::ordered_json::object();
    for (const PassSum& sum : sums) json[sum.name] = median(sum.ms);
    return json;
}

std::string frame_times_text(const FrameTimes& times) {
    const auto line = [](const char* what, const std::vector<double>& ms) {
        return fmt::format("{}: {} p50, {} p99\n", what, ms_text(median(ms)), ms_text(quantile(ms, 0.99)));
    };
    return line("CPU ms a frame", times.cpu) + line("GPU ms a frame", times.gpu) + line("latency, ms", times.latency);
}

void add_frame_times(const FrameTimes& times, nlohmann::ordered_json& facts) {
    for (const auto& [name, ms] :
         {std::pair{"cpu_ms", &times.cpu}, std::pair{"gpu_ms", &times.gpu}, std::pair{"latency_ms", &times.latency}})
        facts[name] = {{"p50", median(*ms)}, {"p99", quantile(*ms, 0.99)}};
}

}  // namespace neuvv::bench

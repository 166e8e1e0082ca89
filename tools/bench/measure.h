// What the measurements of neuvv-bench share. At the end: its verbs, each of which adds its subcommand with options,
// help and callback.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <utility>
#include <vector>

#include "render/frame/frame_renderer.h"
#include "stage/stage.h"
#include "tools/commands.h"

namespace neuvv::bench {

// What a user may set of a measurement. Each verb has those of these options that it adds.
struct BenchOptions {
    std::string scene;
    std::string size = "1280x720";  // of images; empty: the verb makes none
    std::string image;              // the PNG to write; empty: none
    uint32_t views = 4, repeats = 5;
    double slice_budget_mb = static_cast<double>(render::kSliceBudget >> 20);  // MiB
    bool json = false;
};

struct VerbHelp {
    const char *name, *summary;
    std::string explanation;            // of what is measured
    std::vector<std::string> examples;  // what stands behind `neuvv-bench NAME`
    const char* scene = "The .nvv, or the .npz of a PlenOctree";
};

// Adds a verb with its scene and its help.
tools::Command add_scene_verb(tools::Command app, const VerbHelp& help, BenchOptions& options);
// The same with options of its own, which live as long as the verb; its callback is `run`.
template <typename Options>
std::pair<tools::Command, Options&> add_verb(tools::Command app, const tools::CommonOptions& common,
                                             const VerbHelp& help,
                                             void (*run)(const Options&, const tools::CommonOptions&)) {
    const auto options = std::make_shared<Options>();
    tools::Command verb = add_scene_verb(app, help, *options);
    verb.callback([options, &common, run] { run(*options, common); });
    return {verb, *options};
}
void add_size_option(tools::Command verb, BenchOptions& options, const char* help = "WIDTHxHEIGHT");
void add_views_option(tools::Command verb, BenchOptions& options);
void add_repeats_option(tools::Command verb, BenchOptions& options, const char* help);
void add_image_option(tools::Command verb, BenchOptions& options);
void add_json_flag(tools::Command verb, BenchOptions& options);

// Throws RuntimeFailure where the user has asked to stop.
void expect_not_stopped();
// Prints a result: with --json the device, the scene, the size and `facts`, else what `print_table` prints.
void report(const BenchOptions& options, const gpu::Device& device, const nlohmann::ordered_json& facts,
            const std::function<void()>& print_table);

// Images of --size with the slices of --slice-budget.
render::FrameCapacity capacity_of(const BenchOptions& options);
// Plays images of this size over white.
render::FrameSettings play_settings(media::ImageSize size);
// Copies of a clip on the floor of a new stage under its spotlight, in a row along X, so many widths of the clip's box
// apart. Each plays half a clip ahead of the one before it. The stage is never written.
stage::Stage stage_of_copies(const std::filesystem::path& clip, uint32_t copies, double widths_apart);
// How many rays are more opaque than 1/255.
uint64_t covered_rays(const std::vector<glm::vec4>& rays);

// The value that a share `p` of the values does not exceed; 0 of no values.
double quantile(std::vector<double> values, double p);
inline double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}
double mean(const std::vector<double>& values);  // 0 of no values
double milliseconds_since(std::chrono::steady_clock::time_point begin);

// To be called before something is timed: calls `draw` for a second, at least once, and returns how often. Caches fill,
// pipelines are compiled, and GPUs raise the clocks that they lowered while the host compared images.
uint32_t warm_up(const std::function<void()>& draw);
// Bytes read and written per second by a copy from one large buffer of the device to another, the measure of its
// memory's bandwidth: the driver's copy or a compute pass, whichever is faster (on an H100 the pass, three times as
// fast).
double copied_bytes_per_second(const gpu::Device& device);

// How much images of several views differ from their truth.
struct Differences {
    std::vector<double> absolute, squared;  // means over the pixels of each view, of values in [0,1]
    void add(const media::Image& truth, const media::Image& image);
    double mean_of_255() const { return 255 * mean(absolute); }
    double psnr() const;  // of all views together, dB
};

// The pass that brings an image to the host. Times that are sums of passes leave it out, as an image that is shown
// stays on the device.
constexpr const char* kReadbackPass = "readback";
// Of all passes together but the readback.
double milliseconds(const std::vector<gpu::PassTime>& passes);
// "0.136", "1.36", "13.6".
std::string ms_text(double ms);
// What a pass took in every image.
struct PassSum {
    std::string name;
    std::vector<double> ms;  // one number per image, however often the pass ran in it
};
// Adds an image; `sums` keeps the order in which passes first came.
void add_image(std::vector<PassSum>& sums, const std::vector<gpu::PassTime>& passes);
// "shade 1.2, trace 3.4": medians.
std::string passes_text(const std::vector<PassSum>& sums);
nlohmann::ordered_json passes_json(const std::vector<PassSum>& sums);

// The times of images that are shown one after the other, in milliseconds.
struct FrameTimes {
    std::vector<double> cpu;      // the host's work for an image, until it is submitted
    std::vector<double> gpu;      // FrameRenderer::device_milliseconds
    std::vector<double> latency;  // from when the poses, or the time, of the image were taken until it is complete
};
// A line of text for each of them, with the median and the 99th percentile.
std::string frame_times_text(const FrameTimes& times);
// Adds "cpu_ms", "gpu_ms" and "latency_ms", each with "p50" and "p99".
void add_frame_times(const FrameTimes& times, nlohmann::ordered_json& facts);

void add_open(tools::Command app, const tools::CommonOptions& common);
void add_render(tools::Command app, const tools::CommonOptions& common);
void add_slice(tools::Command app, const tools::CommonOptions& common);
void add_stream(tools::Command app, const tools::CommonOptions& common);
void add_walk(tools::Command app, const tools::CommonOptions& common);
void add_instances(tools::Command app, const tools::CommonOptions& common);
void add_stereo(tools::Command app, const tools::CommonOptions& common);
void add_far(tools::Command app, const tools::CommonOptions& common);
void add_stage(tools::Command app, const tools::CommonOptions& common);
void add_play(tools::Command app, const tools::CommonOptions& common);
void add_xr(tools::Command app, const tools::CommonOptions& common);
void add_train(tools::Command app, const tools::CommonOptions& common);
void add_team(tools::Command app, const tools::CommonOptions& common);
void add_edit(tools::Command app, const tools::CommonOptions& common);
void add_coach(tools::Command app, const tools::CommonOptions& common);

}  // namespace neuvv::bench

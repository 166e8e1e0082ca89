// neuvv-bench xr: the time of a headset's frame on the device, and the share of the second eye in it.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/platform.h"
#include "base/seconds.h"
#include "editor/open_file.h"
#include "render/clips/stage_renderer.h"
#include "tools/bench/measure.h"
#include "tools/options.h"
#include "tools/report.h"
#include "xr/draw/eye_camera.h"
#include "xr/draw/eye_pass.h"

namespace neuvv::bench {

namespace {

struct XrOptions : BenchOptions {
    XrOptions() { size = "2064x2208"; }
    uint32_t frames = 360;
    double hz = 90, scale = 1;
};

// A performer on a new stage, or a stage as it is.
stage::Stage stage_of(const XrOptions& options) {
    return editor::has_stage_ending(options.scene) ? stage::load_stage(options.scene)
                                                   : stage_of_copies(options.scene, 1, 0);
}

// The eyes of a person who stands two metres before the performers and sways a little. An eye sees 104 by 96 degrees,
// as in common headsets.
xr::EyeViews eyes_at(const stage::Stage& stage, double time_s) {
    const auto [low, high] = stage::performers_box(stage, stage::stage_at(stage, 0));
    const glm::dvec3 centre = 0.5 * (low + high);
    const glm::dvec3 head(centre.x + 0.12 * std::sin(1.3 * time_s), std::min(high.y, low.y + 1.65), high.z + 2);
    xr::EyeViews eyes{std::vector<xr::EyeView>(xr::kEyes)};
    for (uint32_t eye = 0; eye < xr::kEyes; ++eye) {
        eyes.views[eye].pose.position = head + glm::dvec3((eye - 0.5) * 0.064, 0, 0);
        eyes.views[eye].pose.rotation = glm::angleAxis(0.08 * std::sin(0.7 * time_s), glm::dvec3(0, 1, 0));
        const auto rad = [](double degrees) { return static_cast<float>(glm::radians(degrees)); };
        const double outer = 54, inner = 50;
        eyes.views[eye].fov = {rad(eye == 0 ? -outer : -inner), rad(eye == 0 ? inner : outer), rad(46), rad(-50)};
    }
    return eyes;
}

struct EyeTargets {
    EyeTargets(const gpu::Device& device, media::ImageSize size)
        : colour(device, "eyes",
                 {size.width, size.height, VK_FORMAT_R8G8B8A8_SRGB, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                  VK_SAMPLE_COUNT_1_BIT, 1, xr::kEyes}),
          depth(device, "depth of eyes",
                {size.width, size.height, VK_FORMAT_D32_SFLOAT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                 VK_SAMPLE_COUNT_1_BIT, 1, xr::kEyes}),
          target{colour.image, depth.image, colour.view, depth.view, {size.width, size.height}} {}
    gpu::DeviceImage colour, depth;
    xr::EyeTarget target;
};

struct HeadsetResult {
    // Latency is that from the poses to the images. The host's work is that from showing the stage to the submission,
    // without input and poses; the device has nothing to do meanwhile, as each frame is waited for.
    FrameTimes times;
    // Milliseconds a frame of frames without a pause: each waited for before the next is begun, and recorded while the
    // device draws the one before.
    double waiting_ms = 0, overlapping_ms = 0;
    // Of each frame; left_share is the time of the left eye alone divided by that of both.
    std::vector<double> left_share, eye_pass_ms;
    std::vector<PassSum> passes;  // of both eyes
};

// Draws frames of a stage as a headset shows them.
class XrFrames {
  public:
    XrFrames(const gpu::Device& device, const stage::Stage& stage, const XrOptions& options)
        : stage_(stage),
          options_(options),
          size_(tools::parse_size(options.size)),
          renderer_(device, stage, render::StageLoader(device).load(stage), capacity_of_eyes(size_)),
          targets_(device, size_),
          pass_(device, targets_.colour.shape.format, targets_.depth.shape.format) {}

    // Shows the stage at the time of a frame, and takes the frame's settings.
    void begin(uint32_t frame) {
        const double time_s = frame / options_.hz;
        const double frame_s = std::floor(time_s * stage_.fps) / stage_.fps;
        const stage::EvaluatedStage evaluated = stage::stage_at(stage_, frame_s);
        renderer_.show(evaluated);
        settings_ = renderer_.settings_at(evaluated);
        settings_.width = size_.width;
        settings_.height = size_.height;
        settings_.mode = render::TraceMode::kPlay;
        settings_.scale = options_.scale;
        settings_.next_instances = renderer_.settings_at(stage::stage_at(stage_, frame_s + 1 / stage_.fps)).instances;
    }
    // Takes the poses of the eyes, as late as a headset's frame does.
    void take_poses(uint32_t frame) {
        const xr::EyeViews eyes = eyes_at(stage_, frame / options_.hz);
        for (uint32_t eye = 0; eye < xr::kEyes; ++eye)
            cameras_[eye] = xr::eye_camera(eyes.views[eye], {}, {size_.width, size_.height});
    }
    // Both eyes, brought to the headset's images.
    void draw() { frames().draw(cameras_, settings_, record()); }
    void submit() { frames().submit(cameras_, settings_, record()); }
    // Of the same frame; `eyes` 1: the left one.
    double milliseconds_of(uint32_t eyes) {
        frames().draw({cameras_.data(), eyes}, settings_);
        return frames().device_milliseconds();
    }
    render::FrameRenderer& frames() { return renderer_.frames(); }

  private:
    static render::FrameCapacity capacity_of_eyes(media::ImageSize size) {
        render::FrameCapacity capacity{size.width, size.height};
        capacity.views = xr::kEyes;
        return capacity;
    }
    render::FrameRenderer::Then record() {
        return [this](gpu::Commands& commands, const gpu::Buffer& images) {
            pass_.record(commands, renderer_, images, cameras_, {}, {}, targets_.target);
        };
    }
    const stage::Stage& stage_;
    const XrOptions& options_;
    media::ImageSize size_;
    render::StageRenderer renderer_;
    EyeTargets targets_;
    xr::EyePass pass_;
    render::FrameSettings settings_;
    std::array<stage::Camera, xr::kEyes> cameras_;
};

double eyes_ms(const std::vector<gpu::PassTime>& passes) {
    for (const gpu::PassTime& pass : passes)
        if (pass.name == "eyes") return pass.milliseconds;
    return 0;
}

// Draws frames without a pause, and returns the milliseconds a frame.
double back_to_back_ms(XrFrames& frames, uint32_t count, bool waits) {
    const double begin_s = seconds_now();
    for (uint32_t i = 0; i < count && !stop_requested(); ++i) {
        frames.begin(i);
        frames.take_poses(i);
        frames.submit();
        if (waits) frames.frames().finish();
    }
    frames.frames().finish();
    return 1000 * (seconds_now() - begin_s) / count;
}

// In turns, as clocks change.
void measure_overlap(XrFrames& frames, HeadsetResult& result) {
    constexpr uint32_t kRounds = 5, kFrames = 24;
    std::vector<double> waiting, overlapping;
    for (uint32_t round = 0; round < kRounds; ++round) {
        waiting.push_back(back_to_back_ms(frames, kFrames, true));
        overlapping.push_back(back_to_back_ms(frames, kFrames, false));
    }
    result.waiting_ms = median(waiting);
    result.overlapping_ms = median(overlapping);
}

HeadsetResult measure(const gpu::Device& device, const stage::Stage& stage, const XrOptions& options) {
    XrFrames frames(device, stage, options);
    HeadsetResult result;
    tools::Progress progress("frames", options.frames);
    constexpr uint32_t kWarmUp = 8;  // frames until pipelines and slices are built
    for (uint32_t i = 0; i < options.frames + kWarmUp && !stop_requested(); ++i) {
        const double begin_s = seconds_now();
        frames.begin(i);
        const double poses_s = seconds_now();
        frames.take_poses(i);
        frames.submit();
        const double submitted_s = seconds_now();
        if (!frames.frames().finish()) frames.draw();
        const double complete_s = seconds_now(), both = frames.frames().device_milliseconds();
        const std::vector<gpu::PassTime> passes = frames.frames().pass_times();
        // Both again and the left eye alone, with slices that are there now, so that the difference is the second eye
        // alone.
        const double again = frames.milliseconds_of(xr::kEyes), left = frames.milliseconds_of(1);
        if (i < kWarmUp) continue;
        result.times.cpu.push_back(1000 * (submitted_s - begin_s));
        result.times.gpu.push_back(both);
        result.times.latency.push_back(1000 * (complete_s - poses_s));
        result.eye_pass_ms.push_back(eyes_ms(passes));
        result.left_share.push_back(left / again);
        add_image(result.passes, passes);
        progress.update(i - kWarmUp + 1);
    }
    if (!stop_requested()) measure_overlap(frames, result);
    return result;
}

// The time of the second eye divided by that of the first; 0 where no frame was measured.
double second_eye(const HeadsetResult& result) {
    const double first = median(result.left_share);
    return first > 0 ? (1 - first) / first : 0;
}

void print(const HeadsetResult& result, const gpu::Device& device, const XrOptions& options) {
    const double budget_ms = 1000 / options.hz;
    fmt::print("{}, {} on {}\n", options.scene, options.size, device.summary().name);
    fmt::print("{}", frame_times_text(result.times));
    fmt::print("a frame of both eyes takes {:.0f} % of the device's time at {:.0f} Hz (p99)\n",
               100 * quantile(result.times.gpu, 0.99) / budget_ms, options.hz);
    fmt::print("of which bringing them to the headset's images: {:.1f} ms\n", median(result.eye_pass_ms));
    fmt::print("frames without a pause: {:.2f} ms each, {:.2f} where the next is recorded meanwhile\n",
               result.waiting_ms, result.overlapping_ms);
    const double second = second_eye(result);
    if (second > 0)
        fmt::print("the second eye costs {:.2f} times the first\n", second);
    else
        fmt::print("what the second eye costs is less than these frames vary by: more --frames, or a larger --size\n");
    fmt::print("passes, ms: {}\n", passes_text(result.passes));
}

nlohmann::ordered_json json_of(const HeadsetResult& result) {
    nlohmann::ordered_json facts{{"ms", median(result.times.gpu)},
                                 {"p99_ms", quantile(result.times.gpu, 0.99)},
                                 {"eye_pass_ms", median(result.eye_pass_ms)},
                                 {"second_eye", second_eye(result)},
                                 {"waiting_ms", result.waiting_ms},
                                 {"overlapping_ms", result.overlapping_ms},
                                 {"passes_ms", passes_json(result.passes)}};
    add_frame_times(result.times, facts);
    return facts;
}

void run_xr(const XrOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const stage::Stage stage = stage_of(options);
    const gpu::Device device(common.device);
    const HeadsetResult result = measure(device, stage, options);
    expect_not_stopped();
    report(options, device, json_of(result), [&] { print(result, device, options); });
}

}  // namespace

void add_xr(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(
        app, common,
        {"xr",
         "A frame in a headset, of a stage",
         "Plays the stage before a head that sways, with slices made ahead, and prints "
         "the times of a frame on host and device, and the latency.\nNo headset and no OpenXR runtime are needed.\n",
         {"work/performer.nvv", "work/performer.nvv --size 516x552 --frames 40"},
         "A stage, or a .nvv that is put on one"},
        run_xr);
    add_size_option(verb, options, "WIDTHxHEIGHT of an eye");
    verb.add_option("--frames", options.frames, "Frames that are drawn").in_range(1, 100000).show_default();
    verb.add_option("--hz", options.hz, "Of the display").number_between(1, 1000).show_default();
    verb.add_option("--scale", options.scale, "Rays a pixel along each side").number_between(0.2, 1).show_default();
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

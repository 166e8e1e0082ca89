// neuvv-bench play: a clip that plays in real time, while its segments are read.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "base/platform.h"
#include "render/clips/stage_renderer.h"
#include "tools/bench/measure.h"
#include "tools/options.h"
#include "tools/report.h"

namespace neuvv::bench {

namespace {

using Clock = std::chrono::steady_clock;

struct PlayOptions : BenchOptions {
    PlayOptions() { size = "320x320"; }
    double seconds = 20, seek_every_s = 4;
};

struct PlayResult {
    FrameTimes times;             // latency: from the clock to the image
    std::vector<double> seek_ms;  // from a seek to the first image that shows the performer at its time
    uint64_t frames = 0, missed = 0, held_images = 0;
    uint64_t partial_images = 0;               // that show less of a stream's frame than there is
    uint64_t early_bytes = 0, late_bytes = 0;  // the most buffers on the device in either half
};

void sleep_until(Clock::time_point begin, double after_s) {
    std::this_thread::sleep_until(begin +
                                  std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(after_s)));
}

// Plays from one seek to the next, an image for each frame that is due.
void play_from(double from_s, double until_s, const stage::Stage& stage, const stage::Camera& camera,
               render::StageRenderer& renderer, PlayResult& result, uint64_t& bytes) {
    const Clock::time_point begin = Clock::now();
    bool waiting = true;
    int64_t last_frame = -1;
    for (double played_s = 0; played_s < until_s && !stop_requested();) {
        const Clock::time_point image_begin = Clock::now();
        const stage::EvaluatedStage evaluated = stage::stage_at(stage, from_s + played_s);
        renderer.show(evaluated, true, render::MissingSegments::kHold);
        const bool held = renderer.holds(evaluated);
        const render::FrameSettings settings = renderer.settings_at(evaluated);
        renderer.frames().submit({&camera, 1}, settings);
        result.times.cpu.push_back(milliseconds_since(image_begin));
        if (!renderer.frames().finish()) renderer.frames().draw({&camera, 1}, settings);
        result.times.gpu.push_back(renderer.frames().device_milliseconds());
        result.times.latency.push_back(milliseconds_since(image_begin));
        result.held_images += held ? 1 : 0;
        result.partial_images += !held && !renderer.shows_all(evaluated) ? 1 : 0;
        if (waiting && !held) result.seek_ms.push_back(milliseconds_since(begin));
        waiting = waiting && held;
        bytes = std::max(bytes, renderer.frames().device().buffer_bytes());
        const auto frame = static_cast<int64_t>(std::floor(played_s * stage.fps));
        if (last_frame >= 0) result.missed += static_cast<uint64_t>(std::max<int64_t>(frame - last_frame - 1, 0));
        last_frame = frame;
        sleep_until(begin, std::min(static_cast<double>(frame + 1) / stage.fps, until_s));
        played_s = milliseconds_since(begin) / 1000;
    }
    result.frames += static_cast<uint64_t>(last_frame + 1);
}

PlayResult measure(const gpu::Device& device, const stage::Stage& stage, const PlayOptions& options) {
    render::StageRenderer renderer(device, stage, render::StageLoader(device).load(stage), capacity_of(options));
    const media::ImageSize size = tools::parse_size(options.size);
    const stage::Camera camera = stage::camera_of(stage, "camera", stage::stage_at(stage, 0), size.width, size.height);
    std::mt19937 random(1);
    const double clip_s = stage.clips[0].frames / stage.clips[0].fps;
    PlayResult result;
    uint64_t warm_up_bytes = 0;
    PlayResult warm_up;  // pipelines are compiled
    play_from(0, 0.1, stage, camera, renderer, warm_up, warm_up_bytes);
    tools::Progress progress("seconds", static_cast<uint64_t>(options.seconds));
    for (double done_s = 0; done_s < options.seconds && !stop_requested(); done_s += options.seek_every_s) {
        const double from_s = clip_s * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
        play_from(from_s, std::min(options.seek_every_s, options.seconds - done_s), stage, camera, renderer, result,
                  done_s < options.seconds / 2 ? result.early_bytes : result.late_bytes);
        progress.update(static_cast<uint64_t>(done_s));
    }
    return result;
}

double mebibytes(uint64_t bytes) {
    return static_cast<double>(bytes) / 1048576;
}

void print(const PlayResult& result, const gpu::Device& device, const PlayOptions& options) {
    fmt::print("{}: {}, {}\n", device.summary().name, options.scene, options.size);
    fmt::print(
        "{} frames, of which {} were missed; in {} of {} images the performer was held, in {} not all of it was "
        "there\n",
        result.frames, result.missed, result.held_images, result.times.latency.size(), result.partial_images);
    fmt::print("{}", frame_times_text(result.times));
    fmt::print("an image: {:.1f} ms at most\n", quantile(result.times.latency, 1));
    fmt::print("after a seek: {:.1f} ms median, {:.1f} ms at most, to the performer at its time\n",
               median(result.seek_ms), quantile(result.seek_ms, 1));
    fmt::print(
        "buffers on the device: at most {:.1f} MiB in the first half, {:.1f} MiB in the second; the process at "
        "most {:.0f} MiB\n",
        mebibytes(result.early_bytes), mebibytes(result.late_bytes), mebibytes(peak_memory_bytes()));
}

nlohmann::ordered_json json_of(const PlayResult& result) {
    nlohmann::ordered_json facts{{"frames", result.frames},
                                 {"missed", result.missed},
                                 {"images", result.times.latency.size()},
                                 {"held_images", result.held_images},
                                 {"partial_images", result.partial_images},
                                 {"ms", median(result.times.latency)},
                                 {"p99_ms", quantile(result.times.latency, 0.99)},
                                 {"most_ms", quantile(result.times.latency, 1)},
                                 {"seek_ms", median(result.seek_ms)},
                                 {"most_seek_ms", quantile(result.seek_ms, 1)},
                                 {"early_bytes", result.early_bytes},
                                 {"late_bytes", result.late_bytes}};
    add_frame_times(result.times, facts);
    return facts;
}

void run_play(const PlayOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    const stage::Stage stage = stage_of_copies(options.scene, 1, 0);
    const gpu::Device device(common.device);
    const PlayResult result = measure(device, stage, options);
    expect_not_stopped();
    report(options, device, json_of(result), [&] { print(result, device, options); });
}

}  // namespace

void add_play(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(app, common,
                                    {"play",
                                     "A clip that plays in real time, with seeks",
                                     "Plays a clip on a stage for some seconds, from a random place every few seconds, "
                                     "and loops. Prints frames that "
                                     "were missed because an image took too long, the time until the performer is "
                                     "there after a seek, and memory.\n",
                                     {"work/performer.nvv", "show.nvv --seconds 3600 --seek-every 10"},
                                     "A .nvv, in segments or not, or a .nvs"},
                                    run_play);
    add_size_option(verb, options);
    verb.add_option("--seconds", options.seconds, "How long it plays").number_between(0.1, 1e6).show_default();
    verb.add_option("--seek-every", options.seek_every_s, "Seconds from one seek to the next")
        .number_between(0.1, 1e6)
        .show_default();
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

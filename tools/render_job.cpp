#include "tools/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/platform.h"
#include "gpu/frame_capture.h"
#include "render/frame_passes.h"
#include "tools/progress.h"
#include "tools/report.h"

namespace neuvv::tools {

namespace {

constexpr double kMinFps = 0.01, kMaxFps = 1000;

}  // namespace

render::ResolveSettings resolve_settings(const RenderOptions& options, const ImageOutput& output) {
    const bool video = output.kind == ImageOutput::Kind::kVideo;
    render::ResolveSettings resolve;
    resolve.background =
        parse_colour("--background", options.background.empty() ? (video ? "white" : "clear") : options.background);
    if (options.depth) resolve.show = render::Show::kDepth;
    if (options.alpha) resolve.show = render::Show::kAlpha;
    if (options.level) resolve.show = render::Show::kLevel;
    if (options.cost) resolve.show = render::Show::kCost;
    resolve.cost_max = static_cast<float>(options.cost_max);
    if (video && resolve.show == render::Show::kColour && resolve.background.a < 1)
        throw InputError("--background", options.background, "a video holds no transparency",
                         "choose a colour, or write images: out_%04d.png");
    return resolve;
}

void expect_fitting_output(const ImageOutput& output, size_t images) {
    if (output.kind == ImageOutput::Kind::kImage && images > 1)
        throw InputError("--output", output.path.string(), fmt::format("is one file for {} images", images),
                         "number them, as in out_%04d.png, or give --camera one key and --frames one frame");
}

void expect_fitting_output(const ImageOutput& output, const RenderOptions& options) {
    if (!options.pass.empty() && (output.exr || output.kind == ImageOutput::Kind::kVideo))
        throw InputError("--pass", options.pass, "is written as PNG", "name out.png or out_%04d.png");
    const char* fix = "write .png or .mp4, or leave it out";
    if (!output.exr) return;
    for (const auto& [given, flag] : {std::pair(options.depth, "--depth"), std::pair(options.alpha, "--alpha"),
                                      std::pair(options.level, "--level"), std::pair(options.cost, "--cost")})
        if (given) throw InputError(flag, "", "an .exr holds colour, alpha and depth at once", fix);
    if (options.scale < 1) throw InputError("--scale", "", "what is scaled up is not linear", fix);
}

double checked_fps(const RenderOptions& options, double path_fps, double otherwise) {
    if (options.fps && !(*options.fps >= kMinFps && *options.fps <= kMaxFps))
        throw InputError("--fps", fmt::format("{}", *options.fps), "is not a rate of images",
                         fmt::format("choose {} to {} a second", kMinFps, kMaxFps));
    return options.fps.value_or(path_fps > 0 ? std::clamp(path_fps, kMinFps, kMaxFps) : otherwise);
}

RenderFacts render_facts(const RenderOptions& options, double fps, media::ImageSize size, size_t images) {
    return {{"--fps", fmt::format("{}", fps)},
            {"--size", fmt::format("{}x{}", size.width, size.height)},
            {"--background", options.background.empty() ? "default" : options.background},
            {"--samples", fmt::format("{}", options.samples)},
            {"--scale", fmt::format("{}", options.scale)},
            {"--slice-budget", fmt::format("{}", options.slice_budget_mb)},
            {"--depth", fmt::format("{}", options.depth)},
            {"--alpha", fmt::format("{}", options.alpha)},
            {"--level", fmt::format("{}", options.level)},
            {"--pass", options.pass},
            {"--cost", options.cost ? fmt::format("{}", options.cost_max) : "false"},
            {"pictures", fmt::format("{}", images)},
            {"program", NEUVV_VERSION}};
}

media::Image pass_image(const RenderOptions& options, const render::FrameRenderer& renderer, uint32_t i) {
    const render::FramePass& pass = *render::find_frame_pass(options.pass);
    const render::PassValues values = pass.read(renderer);
    const auto range = render::range_of(values);
    std::FILE* const to = options.json ? stderr : stdout;
    if (range)
        fmt::print(to, "image {}: {} from {:.6g} (dark) to {:.6g} (bright), in {}\n", i, pass.name, range->first,
                   range->second, pass.unit);
    else
        fmt::print(to, "image {}: {} holds nothing\n", i, pass.name);
    return render::colour_mapped(values, range.value_or(std::pair(0.0f, 1.0f)));
}

RenderTotals render_images(const RenderOptions& options, const ImageOutput& output, media::ImageSize size, double fps,
                           uint32_t images, ImageSink& sink, const gpu::Device& device,
                           const std::function<FrameTimes(uint32_t)>& render) {
    catch_stop_signals();
    const bool video = output.kind == ImageOutput::Kind::kVideo;
    const media::ImageSize encoded{media::video_side(size.width), media::video_side(size.height)};
    RenderTotals totals{images, 0, video ? encoded : size, fps};
    Progress progress("render", images);
    for (uint32_t i = 0; i < images; ++i) {
        if (stop_requested())
            throw RuntimeFailure(fmt::format("{}: stopped before the end; {}", options.output,
                                             sink.resumable() ? "--resume goes on with it"
                                             : video ? "begin a video with --resume to be able to go on with it"
                                                     : "begin it anew"));
        if (!sink.has(i)) {
            std::optional<gpu::FrameCapture> capture;
            if (options.capture && totals.rendered == 0) capture.emplace(device);
            const FrameTimes times = render(i);
            if (capture) fmt::print(stderr, "captured image {}: {}\n", i, capture->finish());
            ++totals.rendered;
            totals.seconds += times.milliseconds / 1000;
            if (trace_wanted()) fmt::print(stderr, "image {}: {}\n", i, pass_times_text(times.passes));
        }
        progress.update(i + 1);
    }
    sink.finish(images);
    const double rays_per_image = size.width * size.height * std::pow(options.scale * samples_of(options), 2);
    totals.rays = static_cast<double>(totals.rendered) * rays_per_image;
    return totals;
}

}  // namespace neuvv::tools

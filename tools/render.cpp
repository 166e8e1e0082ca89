// neuvv render: a scene as a free-viewpoint video or as pictures.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "media/video.h"
#include "render/frame.h"
#include "tools/commands.h"
#include "tools/paint_layers.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "voctree/nvv.h"

namespace neuvv {

namespace {

constexpr PictureSize kDefaultSize{720, 720};
constexpr double kMinFps = 0.01, kMaxFps = 1000;

struct RenderOptions {
    std::string scene, output, camera, frames, size, background;
    std::vector<std::string> paint;
    std::optional<double> fps;  // the clip's where not given
    uint32_t samples = kDefaultSamples;
    double scale = 1;
    double slice_budget_mb = static_cast<double>(kSliceBudget >> 20);
    bool orbit = false, depth = false, alpha = false, direct = false, json = false;
};

// Takes pictures one by one: into a video, or files of their own.
class PictureSink {
  public:
    PictureSink(PictureOutput output, PictureSize size, double fps) : output_(std::move(output)) {
        if (output_.kind == PictureOutput::Kind::kVideo) video_.emplace(output_.path, size.width, size.height, fps);
    }
    void add(const Image& picture) {
        if (video_)
            video_->add(picture);
        else
            write_png(output_.file(count_++), picture);
    }
    void finish() {
        if (video_) video_->finish();
    }

  private:
    PictureOutput output_;
    std::optional<VideoWriter> video_;
    uint32_t count_ = 0;
};

ResolveSettings resolve_settings(const RenderOptions& options, const PictureOutput& output) {
    const bool video = output.kind == PictureOutput::Kind::kVideo;
    ResolveSettings resolve;
    resolve.background = parse_colour(options.background.empty() ? (video ? "white" : "clear") : options.background);
    if (options.depth) resolve.show = Show::kDepth;
    if (options.alpha) resolve.show = Show::kAlpha;
    if (video && resolve.show == Show::kColour && resolve.background.a < 1)
        throw InputError("--background", options.background, "a video holds no transparency",
                         "choose a colour, or write pictures: out_%04d.png");
    return resolve;
}

std::vector<ViewStep> view_path(const RenderOptions& options, const VOctree& tree, const Playback& playback,
                                PictureSize size) {
    if (options.camera.empty()) return orbit_path(occupied_box(tree), playback, size.width ? size : kDefaultSize);
    return key_path(load_camera_path(options.camera), playback, tree.frames, size, kDefaultSize);
}

void expect_fitting_output(const PictureOutput& output, size_t pictures) {
    if (output.kind == PictureOutput::Kind::kPicture && pictures > 1)
        throw InputError("--output", output.path.string(), fmt::format("is one file for {} pictures", pictures),
                         "number them, as in out_%04d.png, or give --camera one key and --frames one frame");
}

struct Totals {
    size_t pictures = 0;
    PictureSize size;
    double fps = 0, rays = 0, seconds = 0;
};

Totals render(const RenderOptions& options, const CommonOptions& common) {
    const PictureOutput output = parse_output(options.output);
    ResolveSettings resolve = resolve_settings(options, output);
    if (options.fps && !(*options.fps >= kMinFps && *options.fps <= kMaxFps))
        throw InputError("--fps", fmt::format("{}", *options.fps), "is not a rate of pictures",
                         fmt::format("choose {} to {} a second", kMinFps, kMaxFps));
    prepare_output_file("--output", output.path);
    const PictureSize wanted = options.size.empty() ? PictureSize{} : parse_size(options.size);
    const VOctree tree = read_nvv(options.scene);
    const PaintStack paint = read_paint_stack(options.paint, painted_field(tree));
    const Playback playback{parse_frame_range(options.frames, tree.frames), double{tree.fps},
                            options.fps.value_or(double{tree.fps})};
    std::vector<ViewStep> path = view_path(options, tree, playback, wanted);
    const bool instant = playback.range.first == playback.range.last;
    if (instant && output.kind == PictureOutput::Kind::kPicture && options.camera.empty())
        path.resize(1);  // a still: the orbit's first view
    expect_fitting_output(output, path.size());
    const auto [near, far] = depth_range(path, occupied_box(tree));
    resolve.depth_near_m = static_cast<float>(near);
    resolve.depth_far_m = static_cast<float>(far);
    const PictureSize size{path[0].camera.width, path[0].camera.height};

    const Device device(common.device);
    const Field field = upload_field(device, tree, WeightPrecision::kHalf);
    const uint32_t samples = options.scale < 1 ? 1 : options.samples;
    const auto slice_bytes = static_cast<uint64_t>(options.slice_budget_mb * 1048576);
    FrameRenderer renderer(device, field, {size.width, size.height, samples, 1, slice_bytes});
    const uint32_t painted = paint.uses.empty() ? 0 : renderer.paints().add(paint.uses);
    PictureSink sink(output, size, playback.output_fps);
    catch_stop_signals();
    const bool video = output.kind == PictureOutput::Kind::kVideo;
    const PictureSize encoded{video_side(size.width), video_side(size.height)};
    Totals totals{path.size(), video ? encoded : size, playback.output_fps};
    const double rays_a_pixel = std::pow(options.scale * samples, 2);
    totals.rays = static_cast<double>(path.size()) * size.width * size.height * rays_a_pixel;
    Progress progress("render", path.size());
    for (size_t i = 0; i < path.size(); ++i) {
        if (stop_requested()) throw RuntimeFailure(fmt::format("{}: stopped before the end", options.output));
        FrameSettings settings;
        settings.instances[0].frame = static_cast<float>(path[i].frame);
        settings.instances[0].paint = painted;
        settings.width = size.width;
        settings.height = size.height;
        settings.samples = samples;
        settings.scale = options.scale;
        settings.resolve = resolve;
        settings.mode = options.direct ? TraceMode::kDirect : TraceMode::kPlay;
        sink.add(renderer.render(path[i].camera, settings));
        for (const PassTime& pass : renderer.pass_times()) totals.seconds += pass.milliseconds / 1000;
        if (trace_wanted()) fmt::print(stderr, "picture {}: {}\n", i, pass_times_text(renderer.pass_times()));
        progress.update(i + 1);
    }
    sink.finish();
    return totals;
}

void run(const RenderOptions& options, const CommonOptions& common) {
    const Totals totals = render(options, common);
    const double mrays_per_s = totals.seconds > 0 ? totals.rays / totals.seconds / 1e6 : 0;
    if (options.json)
        fmt::print("{}", json_text({{"output", options.output},
                                    {"pictures", totals.pictures},
                                    {"width", totals.size.width},
                                    {"height", totals.size.height},
                                    {"fps", totals.fps},
                                    {"gpu_seconds", totals.seconds},
                                    {"mrays_per_second", mrays_per_s}}));
    else
        fmt::print("{}: {} pictures of {}x{}, {:.1f} ms each on the device, {:.1f} Mrays/s\n", options.output,
                   totals.pictures, totals.size.width, totals.size.height,
                   1000 * totals.seconds / static_cast<double>(totals.pictures), mrays_per_s);
}

void add_options(CLI::App& verb, RenderOptions& options) {
    verb.add_option("scene", options.scene, "The .nvv file")->required();
    verb.add_option(
            "-o,--output", options.output,
            "out.mp4, or out_%04d.png, or out.png for a single picture, of one instant (--frames F) the orbit's first")
        ->required();
    CLI::Option* orbit =
        verb.add_flag("--orbit", options.orbit,
                      "Turn around the scene while the clip plays, which repeats until 4 s have passed (default)");
    verb.add_option("--camera", options.camera,
                    "A transforms.json: one picture a key, at its time, else as the clip plays. One key without a time "
                    "is a fixed camera")
        ->excludes(orbit);
    verb.add_option(
        "--frames", options.frames,
        "FIRST:LAST frame of the clip, from 0, fractions allowed; one number: that instant. Keys of --camera "
        "with a time ignore it");
    verb.add_option("--fps", options.fps,
                    "Pictures a second (default: the clip's); the clip keeps its speed, and frames between its own are "
                    "interpolated");
    verb.add_option("--size", options.size, "WIDTHxHEIGHT (default: that of --camera, else 720x720)");
    verb.add_option("--background", options.background,
                    "white, black, grey, clear or '#rrggbb' (default: white for a video, clear for pictures)");
    CLI::Option* samples = add_samples_option(verb, options.samples);
    CLI::Option* scale =
        verb.add_option("--scale", options.scale,
                        "Rays a pixel along each side, below 1, scaled up: fast, for previews; in place of --samples")
            ->check(number_between(0.1, 1))
            ->excludes(samples);
    CLI::Option* paint = verb.add_option("--paint", options.paint,
                                         "LAYER.nvpaint[:BLEND[:OPACITY]],...: layers of `neuvv paint`, the lowest "
                                         "first; normal, multiply, tint or recolour")
                             ->delimiter(',');
    add_slice_budget_option(verb, options.slice_budget_mb);
    CLI::Option* depth = verb.add_flag("--depth", options.depth, "Show depth: near is white, far is black");
    verb.add_flag("--alpha", options.alpha, "Show alpha: solid is white")->excludes(depth);
    verb.add_flag("--direct", options.direct, "Evaluate all weights at each sample (the paper's path; slow)")
        ->excludes(scale)
        ->excludes(paint);
    verb.add_flag("--json", options.json, "Print JSON: output, pictures, width, height, fps, gpu_seconds, ...");
}

}  // namespace

void add_render(CLI::App& app, CommonOptions& common) {
    CLI::App* verb = app.add_subcommand("render", "Render a scene to a free-viewpoint video or to pictures");
    const auto options = std::make_shared<RenderOptions>();
    add_options(*verb, *options);
    verb->footer(std::string("NEUVV_TRACE=1 prints the time of each pass.\n") + kDeviceHelp + kExamplesHead +
                 "  neuvv render build/performer.nvv -o build/turn.mp4\n"
                 "  neuvv render build/performer.nvv -o build/still.png --frames 1.5 --size 1280x720\n"
                 "  neuvv render build/performer.nvv -o build/seen.mp4 --camera build/performer/transforms_test.json "
                 "--size 480x480\n"
                 "  neuvv render build/performer.nvv -o build/depth.mp4 --depth --frames 0");
    verb->callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv

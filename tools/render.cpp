// neuvv render: a scene as a free-viewpoint video or as pictures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "render/frame.h"
#include "render/linear_picture.h"
#include "tools/commands.h"
#include "tools/picture_sink.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "tools/view_path.h"
#include "training/camera_path_file.h"
#include "voctree/nvv.h"

namespace neuvv {

namespace {

constexpr PictureSize kDefaultSize{720, 720};
constexpr double kMinFps = 0.01, kMaxFps = 1000;

struct RenderOptions {
    std::string scene, output, camera, frames, size, background;
    std::optional<double> fps;  // the clip's where not given
    uint32_t samples = kDefaultSamples;
    double scale = 1;
    double slice_budget_mb = static_cast<double>(kSliceBudget >> 20);
    bool orbit = false, depth = false, alpha = false, direct = false, resume = false, json = false;
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
    const CameraPath path = read_camera_path(options.camera, playback.output_fps);
    return path_steps(path, playback, tree.frames, size, kDefaultSize);
}

void expect_fitting_output(const PictureOutput& output, size_t pictures) {
    if (output.kind == PictureOutput::Kind::kPicture && pictures > 1)
        throw InputError("--output", output.path.string(), fmt::format("is one file for {} pictures", pictures),
                         "number them, as in out_%04d.png, or give --camera one key and --frames one frame");
}

void expect_fitting_output(const PictureOutput& output, const RenderOptions& options) {
    const char* mend = "write .png or .mp4, or leave it out";
    if (!output.exr) return;
    if (options.depth) throw InputError("--depth", "", "an .exr holds colour, alpha and depth at once", mend);
    if (options.alpha) throw InputError("--alpha", "", "an .exr holds colour, alpha and depth at once", mend);
    if (options.scale < 1) throw InputError("--scale", "", "what is scaled up is not linear", mend);
}

// All that the pictures depend on but the device, whose rounding nobody sees.
RenderFacts render_facts(const RenderOptions& options, const Playback& playback, PictureSize size, size_t pictures) {
    return {{"scene", content_fact(options.scene)},
            {"--camera", options.camera.empty() ? "orbit" : content_fact(options.camera)},
            {"--frames", fmt::format("{}:{}", playback.range.first, playback.range.last)},
            {"--fps", fmt::format("{}", playback.output_fps)},
            {"--size", fmt::format("{}x{}", size.width, size.height)},
            {"--background", options.background.empty() ? "default" : options.background},
            {"--samples", fmt::format("{}", options.samples)},
            {"--scale", fmt::format("{}", options.scale)},
            {"--slice-budget", fmt::format("{}", options.slice_budget_mb)},
            {"--depth", fmt::format("{}", options.depth)},
            {"--alpha", fmt::format("{}", options.alpha)},
            {"--direct", fmt::format("{}", options.direct)},
            {"pictures", fmt::format("{}", pictures)},
            {"program", NEUVV_VERSION}};
}

struct Totals {
    size_t pictures = 0, rendered = 0;
    PictureSize size;
    double fps = 0, rays = 0, seconds = 0;
};

// What is rendered, all of it known before the device is touched.
struct RenderPlan {
    PictureOutput output;
    ResolveSettings resolve;
    VOctree tree;
    Playback playback;
    std::vector<ViewStep> path;
    PictureSize size;
    uint32_t samples = 1;
};

RenderPlan plan_render(const RenderOptions& options) {
    RenderPlan plan;
    plan.output = parse_output(options.output);
    plan.resolve = resolve_settings(options, plan.output);
    expect_fitting_output(plan.output, options);
    if (options.fps && !(*options.fps >= kMinFps && *options.fps <= kMaxFps))
        throw InputError("--fps", fmt::format("{}", *options.fps), "is not a rate of pictures",
                         fmt::format("choose {} to {} a second", kMinFps, kMaxFps));
    prepare_output_file("--output", plan.output.path);
    const PictureSize wanted = options.size.empty() ? PictureSize{} : parse_size(options.size);
    plan.tree = read_nvv(options.scene);
    const double clip_fps = plan.tree.fps;
    plan.playback = {parse_frame_range(options.frames, plan.tree.frames), clip_fps, options.fps.value_or(clip_fps)};
    plan.path = view_path(options, plan.tree, plan.playback, wanted);
    const bool instant = plan.playback.range.first == plan.playback.range.last;
    if (instant && plan.output.kind == PictureOutput::Kind::kPicture && options.camera.empty())
        plan.path.resize(1);  // a still: the orbit's first view
    expect_fitting_output(plan.output, plan.path.size());
    const auto [near, far] = depth_range(plan.path, occupied_box(plan.tree));
    plan.resolve.depth_near_m = static_cast<float>(near);
    plan.resolve.depth_far_m = static_cast<float>(far);
    plan.size = {plan.path[0].camera.width, plan.path[0].camera.height};
    plan.samples = options.scale < 1 ? 1 : options.samples;
    return plan;
}

void render_picture(FrameRenderer& renderer, const RenderOptions& options, const RenderPlan& plan, uint32_t i,
                    PictureSink& sink) {
    FrameSettings settings;
    settings.instances[0].frame = static_cast<float>(plan.path[i].frame);
    settings.width = plan.size.width;
    settings.height = plan.size.height;
    settings.samples = plan.samples;
    settings.scale = options.scale;
    settings.resolve = plan.resolve;
    settings.mode = options.direct ? TraceMode::kDirect : TraceMode::kPlay;
    const Image picture = renderer.render(plan.path[i].camera, settings);
    if (sink.exr())
        sink.add(i, linear_picture(renderer.radiance(), renderer.depth(), plan.size.width, plan.size.height,
                                   plan.samples, plan.resolve.background));
    else
        sink.add(i, picture);
}

Totals render(const RenderOptions& options, const CommonOptions& common) {
    const RenderPlan plan = plan_render(options);
    const PictureSize size = plan.size;
    const auto pictures = static_cast<uint32_t>(plan.path.size());
    PictureSink sink(plan.output, size, plan.playback.output_fps, render_facts(options, plan.playback, size, pictures),
                     options.resume);
    const Device device(common.device);
    const Field field = upload_field(device, plan.tree, WeightPrecision::kHalf);
    const auto slice_bytes = static_cast<uint64_t>(options.slice_budget_mb * 1048576);
    FrameRenderer renderer(device, field, {size.width, size.height, plan.samples, 1, slice_bytes});
    catch_stop_signals();
    const bool video = plan.output.kind == PictureOutput::Kind::kVideo;
    const PictureSize encoded{video_side(size.width), video_side(size.height)};
    Totals totals{pictures, 0, video ? encoded : size, plan.playback.output_fps};
    Progress progress("render", pictures);
    for (uint32_t i = 0; i < pictures; ++i) {
        if (stop_requested())
            throw RuntimeFailure(fmt::format("{}: stopped before the end{}", options.output,
                                             sink.resumable() ? "; --resume goes on with it" : ""));
        if (!sink.has(i)) {
            render_picture(renderer, options, plan, i, sink);
            ++totals.rendered;
            for (const PassTime& pass : renderer.pass_times()) totals.seconds += pass.milliseconds / 1000;
            if (trace_wanted()) fmt::print(stderr, "picture {}: {}\n", i, pass_times_text(renderer.pass_times()));
        }
        progress.update(i + 1);
    }
    sink.finish(pictures);
    const double rays_a_picture = size.width * size.height * std::pow(options.scale * plan.samples, 2);
    totals.rays = static_cast<double>(totals.rendered) * rays_a_picture;
    return totals;
}

void run(const RenderOptions& options, const CommonOptions& common) {
    const Totals totals = render(options, common);
    const double mrays_per_s = totals.seconds > 0 ? totals.rays / totals.seconds / 1e6 : 0;
    if (options.json)
        fmt::print("{}", json_text({{"output", options.output},
                                    {"pictures", totals.pictures},
                                    {"rendered", totals.rendered},
                                    {"width", totals.size.width},
                                    {"height", totals.size.height},
                                    {"fps", totals.fps},
                                    {"gpu_seconds", totals.seconds},
                                    {"mrays_per_second", mrays_per_s}}));
    else
        fmt::print("{}: {} pictures of {}x{}, {} of them rendered now, {:.1f} ms each on the device, {:.1f} Mrays/s\n",
                   options.output, totals.pictures, totals.size.width, totals.size.height, totals.rendered,
                   1000 * totals.seconds / static_cast<double>(std::max<size_t>(1, totals.rendered)), mrays_per_s);
}

void add_options(CLI::App& verb, RenderOptions& options) {
    verb.add_option("scene", options.scene, "The .nvv file")->required();
    verb.add_option(
            "-o,--output", options.output,
            "out.mp4, or out_%04d.png, or out.png for a single picture, of one instant (--frames F) the orbit's first; "
            ".exr: linear light, premultiplied alpha and Z in metres")
        ->required();
    CLI::Option* orbit =
        verb.add_flag("--orbit", options.orbit,
                      "Turn around the scene while the clip plays, which repeats until 4 s have passed (default)");
    verb.add_option(
            "--camera", options.camera,
            "A camera path of instant-ngp or nerfstudio, or a transforms.json: with seconds a path, else one "
            "picture a key. At the keys' times of the clip, else as it plays. One key without a time is a fixed "
            "camera")
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
    add_slice_budget_option(verb, options.slice_budget_mb);
    CLI::Option* depth = verb.add_flag("--depth", options.depth, "Show depth: near is white, far is black");
    verb.add_flag("--alpha", options.alpha, "Show alpha: solid is white")->excludes(depth);
    verb.add_flag("--direct", options.direct, "Evaluate all weights at each sample (the paper's path; slow)")
        ->excludes(scale);
    verb.add_flag("--resume", options.resume,
                  "Go on with a render that was interrupted. Numbered pictures always can; a video can if it was begun "
                  "so, and keeps its pictures beside it until it is whole");
    verb.add_flag("--json", options.json,
                  "Print JSON: output, pictures, rendered, width, height, fps, gpu_seconds, ...");
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
                 "  neuvv render build/performer.nvv -o build/shot/out_%04d.exr --camera path.json --resume\n"
                 "  neuvv render build/performer.nvv -o build/depth.mp4 --depth --frames 0");
    verb->callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv

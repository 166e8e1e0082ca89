// neuvv render: renders a clip or a stage to a free-viewpoint video or to images.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/platform.h"
#include "base/text.h"
#include "editor/open_file.h"
#include "gpu/frame_capture.h"
#include "media/image_sink.h"
#include "render/frame/frame_passes.h"
#include "stream/transport/nvs_reader.h"
#include "tools/options.h"
#include "tools/remedies.h"
#include "tools/render/render.h"
#include "tools/render/render_layers.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"
#include "voctree/files/clip_index.h"

namespace neuvv::tools {

namespace {

constexpr double kMinFps = 0.01, kMaxFps = 1000;

void run(const RenderOptions& options, const CommonOptions& common) {
    catch_stop_signals();  // before the files of a long clip are read, too, so that a job is told that it was stopped
    const RenderTotals totals =
        editor::has_stage_ending(options.scene) ? render_stage(options, common) : render_clip(options, common);
    const double mrays_per_s = totals.seconds > 0 ? totals.rays / totals.seconds / 1e6 : 0;
    if (options.json)
        tell("{}", json_text({{"output", options.output},
                              {"images", totals.images},
                              {"rendered", totals.rendered},
                              {"width", totals.size.width},
                              {"height", totals.size.height},
                              {"fps", totals.fps},
                              {"seconds", totals.seconds},
                              {"mrays_per_second", mrays_per_s}}));
    else if (options.plan)
        tell("{}: {} images of {}x{}, {:g} a second\n", options.output, totals.images, totals.size.width,
             totals.size.height, totals.fps);
    else
        tell("{}: {} images of {}x{}, {} of them rendered now, {:.1f} ms each, {:.1f} Mrays/s\n", options.output,
             totals.images, totals.size.width, totals.size.height, totals.rendered,
             1000 * totals.seconds / static_cast<double>(std::max<size_t>(1, totals.rendered)), mrays_per_s);
}

void print_passes() {
    for (const render::FramePass& pass : render::frame_passes())
        tell("{:<22} {} [{}]{}\n", pass.name, pass.shows, pass.unit, pass.needs_set ? ", of stages" : "");
}

// `--pass list` prints and ends the program while options are parsed, so it needs none of the verb's other arguments.
Option add_pass_option(Command verb, RenderOptions& options) {
    return verb.add_parsed_option(
        "--pass",
        [&options](const std::string& name) {
            if (name == "list") {
                print_passes();
                throw Command::Finished();
            }
            if (!render::find_frame_pass(name))
                throw Command::WrongValue{name + " is none of the passes that --pass list prints"};
            options.pass = name;
        },
        "Show an intermediate buffer of each frame, a PNG in the colours of viridis, and print the range of its "
        "values. `--pass list` prints the names, and what each shows in which unit");
}

// How a stage is drawn, and how the run goes.
void add_run_options(Command verb, RenderOptions& options) {
    add_choice(verb, "--blend", options.blend, stage::kStageBlendNames,
               "Of a stage: performers that stand in each other exactly, or as layers as in the paper");
    add_switch(verb, "--shadows", options.shadows, "Of a stage: whether lights cast shadows");
    add_switch(verb, "--falloff", options.falloff, "Of a stage: whether lights shine on performers");
    add_far_levels_option(verb, options.far_levels);
    add_up_option(verb, options.up);
    verb.add_option("--part", options.part,
                    "2/8: render the second of eight parts of the images, as other processes render the others. The "
                    "process that finds all parts of a video joins them. All need the same options. The ranks of "
                    "mpirun and srun take parts without it");
    verb.add_flag("--resume", options.resume,
                  "Go on with a render that was interrupted. Numbered images always can, by the record beside them "
                  "(X_render.json for X_%04d.png); a video can if it was begun so, and keeps its images beside it "
                  "until it is whole");
    verb.add_flag(
        "--plan", options.plan,
        "Check the options and what they name, make the output's folder, say how many images there would be, and "
        "draw none");
    verb.add_flag("--capture", options.capture,
                  "Capture the first image with RenderDoc, and say where; needs `renderdoccmd capture neuvv render …`");
    verb.add_flag("--json", options.json,
                  "Print JSON: output, images, rendered, width, height, fps, seconds (from submission until the "
                  "images were there), ...");
}

// Which times are shown, from where, how large and before what.
void add_view_options(Command verb, RenderOptions& options) {
    Option orbit =
        verb.add_flag("--orbit", options.orbit,
                      "Turn around the scene while the clip plays, which repeats until 4 s have passed (default)");
    verb.add_option(
            "--camera", options.camera,
            "A camera path of instant-ngp or nerfstudio, or a transforms.json: with seconds a path, else one "
            "image a key. At the keys' times of the clip, else as it plays. One key without a time is a fixed "
            "camera. Of a stage also `path`, its own camera path (neuvv stage path), for as long as the stage lasts, "
            "or the "
            "name of one of its cameras (default: its first camera, also where it has a path)")
        .excludes(orbit);
    verb.add_option("--frames", options.frames,
                    "FIRST:LAST frame of the clip, from 0, fractions allowed; one number: that time. An orbit repeats "
                    "them for 4 s. Keys of --camera with a time ignore it");
    verb.add_option(
        "--time", options.time,
        "Of a stage: FROM:TO in seconds, or one time, up to its end where nothing loops (default: all of it)");
    verb.add_option("--fps", options.fps,
                    "Images a second (default: that of --camera, else the clip's or the stage's); the clip keeps its "
                    "speed, and frames "
                    "between its own are "
                    "interpolated");
    verb.add_option("--size", options.size,
                    "WIDTHxHEIGHT (default: that of --camera, else 720x720, of a stage 1280x720)");
    verb.add_option(
        "--background", options.background,
        "A colour's name, '#rrggbb' or clear (default: white for an .mp4, else clear; of a stage its own). It "
        "hides the image of a stage's environment, whose light stays");
}

// What images show of the scene, and by which passes. `scale` and `paint` are options that exclude the paper's path.
void add_shown_options(Command verb, RenderOptions& options, Option scale, Option paint) {
    Option depth = verb.add_flag("--depth", options.depth, "Show depth: near is white, far is black");
    Option alpha = verb.add_flag("--alpha", options.alpha, "Show alpha: solid is white").excludes(depth);
    Option level = verb.add_flag("--level", options.level,
                                 "Show how deep in the octree the leaf lies in which a ray's alpha first passes "
                                 "0.5: the coarsest level is dark, the finest bright (viridis). Of performers "
                                 "alone, without a stage's set")
                       .excludes(depth)
                       .excludes(alpha);
    Option cost = verb.add_flag("--cost", options.cost,
                                "Show what each ray costs: how many nodes of the octree its walk comes to and "
                                "leaves it samples, in all performers (viridis), without a stage's set")
                      .excludes(depth)
                      .excludes(alpha)
                      .excludes(level);
    verb.add_option("--cost-max", options.cost_max, "The cost from which --cost is brightest (default: 256)")
        .number_between(1, 1e6)
        .needs(cost);
    Option pass = add_pass_option(verb, options).excludes(depth).excludes(alpha).excludes(level).excludes(cost);
    verb.add_flag("--direct", options.direct,
                  "Evaluate all weights at each sample, without far levels and fades between segments (the paper's "
                  "path; slow)")
        .excludes(scale)
        .excludes(paint)
        .excludes(pass)
        .excludes(level)
        .excludes(cost);
}

void add_options(Command verb, RenderOptions& options) {
    verb.add_option("scene", options.scene,
                    "A .nvv file, the .npz of a PlenOctree, or a stage: .gltf or .glb (neuvv stage)")
        .required();
    verb.add_option("-o,--output", options.output,
                    "out.mp4; out.mov: ProRes 4444 with straight alpha; out_%04d.png, or out.png for a single image: "
                    "the first frame, or that of --frames, from where the orbit begins or from --camera's one key; "
                    ".exr: linear light, premultiplied alpha and Z in metres, of a stage with --background clear, too")
        .required();
    verb.add_option("--layers", options.layers,
                    "Of an .exr: some of rgba, depth (Z along the camera's axis, metres), ids (Cryptomatte with the "
                    "performers' names) and deep (deep samples, in a file out_deep.exr beside it); default rgba,depth");
    add_view_options(verb, options);
    Option samples = add_samples_option(verb, options.samples);
    Option scale =
        verb.add_option("--scale", options.scale,
                        "Rays a pixel along each side, below 1, scaled up: fast, for previews; in place of --samples")
            .number_between(0.1, 1)
            .excludes(samples);
    Option paint = verb.add_option("--paint", options.paint,
                                   "LAYER.nvpaint[:BLEND[:OPACITY]],...: layers of `neuvv paint`, the lowest "
                                   "first; normal, multiply, tint or recolour. Of a stage: its performers' own")
                       .delimiter(',');
    add_slice_budget_option(verb, options.slice_budget_mb);
    add_shown_options(verb, options, scale, paint);
    add_run_options(verb, options);
}

}  // namespace

render::ResolveSettings resolve_settings(const RenderOptions& options, const media::ImageOutput& output) {
    render::ResolveSettings resolve;
    resolve.background = parse_colour(
        "--background", options.background.empty() ? (output.holds_alpha() ? "clear" : "white") : options.background);
    if (options.depth) resolve.show = render::Show::kDepth;
    if (options.alpha) resolve.show = render::Show::kAlpha;
    if (options.level) resolve.show = render::Show::kLevel;
    if (options.cost) resolve.show = render::Show::kCost;
    resolve.cost_max = static_cast<float>(options.cost_max);
    if (!output.holds_alpha() && resolve.show == render::Show::kColour && resolve.background.a < 1)
        throw InputError("--background", options.background, "an .mp4 holds no transparency",
                         "choose a colour, or write out.mov or out_%04d.png");
    return resolve;
}

void expect_new_images(const RenderOptions& options, const media::ImageOutput& output, uint32_t images) {
    const PartNumber number = part_number(options.part, ranks_of_environment());
    std::error_code ignored;
    const bool video = output.kind == media::ImageOutput::Kind::kVideo;
    const bool begun = !video || number.parts > 1 || std::filesystem::exists(output.path.string() + ".frames", ignored);
    if (options.resume && begun) return;
    const media::ImageRange range = options.plan ? media::ImageRange{0, images} : images_of(number, images);
    prepare_images("--output", output, range.first, range.end);
}

void expect_fitting_output(const media::ImageOutput& output, size_t images) {
    if (output.kind == media::ImageOutput::Kind::kImage && images > 1)
        throw InputError(
            "--output", output.path.string(), fmt::format("is one file for {} images", images),
            "number them, as in out_%04d.png, or name one time by --frames or --time, and one key by --camera");
}

void expect_fitting_output(const media::ImageOutput& output, const RenderOptions& options) {
    if (!options.pass.empty() && (output.exr || output.kind == media::ImageOutput::Kind::kVideo))
        throw InputError("--pass", options.pass, "is written as PNG", "name out.png or out_%04d.png");
    if (!options.layers.empty() && !output.exr)
        throw InputError("--layers", options.layers, "are those of an .exr", "name out.exr or out_%04d.exr");
    if (!output.exr) return;
    if (parse_layers(options.layers).needs_segments() && options.direct)
        throw InputError("--layers", options.layers, "are not drawn by the paper's path", "leave --direct out");
    const char* fix = "write .png or .mp4, or leave it out";
    for (const auto& [given, flag] : {std::pair(options.depth, "--depth"), std::pair(options.alpha, "--alpha"),
                                      std::pair(options.level, "--level"), std::pair(options.cost, "--cost")})
        if (given) throw InputError(flag, "", "an .exr holds colour, alpha and depth at once", fix);
    if (options.scale < 1) throw InputError("--scale", "", "what is scaled up is not linear", fix);
}

double checked_fps(const RenderOptions& options, double path_fps, double fallback) {
    if (options.fps && !(*options.fps >= kMinFps && *options.fps <= kMaxFps))
        throw InputError("--fps", fmt::format("{}", *options.fps), "is not a rate of images",
                         fmt::format("choose {} to {} a second", kMinFps, kMaxFps));
    return options.fps.value_or(path_fps > 0 ? std::clamp(path_fps, kMinFps, kMaxFps) : fallback);
}

std::string device_of(const CommonOptions& common) {
    return device_of_rank(ranks_of_environment(), common.device);
}

media::RenderFacts render_facts(const RenderOptions& options, double fps, media::ImageSize size, size_t images) {
    return {{"--fps", fmt::format("{}", fps)},
            {"--size", fmt::format("{}x{}", size.width, size.height)},
            {"--background", options.background.empty() ? "default" : options.background},
            {"--samples", fmt::format("{}", options.samples)},
            {"--scale", fmt::format("{}", options.scale)},
            {"--far-levels", fmt::format("{}", options.far_levels.value_or(true))},
            {"--slice-budget", fmt::format("{}", options.slice_budget_mb)},
            {"--depth", fmt::format("{}", options.depth)},
            {"--alpha", fmt::format("{}", options.alpha)},
            {"--layers", options.layers.empty() ? "default" : options.layers},
            {"--level", fmt::format("{}", options.level)},
            {"--pass", options.pass},
            {"--cost", options.cost ? fmt::format("{}", options.cost_max) : "false"},
            {"images", fmt::format("{}", images)},
            {"program", NEUVV_VERSION}};
}

void add_clip_facts(media::RenderFacts& facts, const std::string& name, const std::filesystem::path& clip) {
    if (stream::is_address(clip)) {
        const FileStamp stamp = stream::Reader(clip).stamp();
        facts[name] = fmt::format("{}, {} bytes", without_passwords(clip.string()), stamp.bytes);
        return;
    }
    if (!voctree::is_segmented(clip)) {
        facts[name] = media::content_fact(clip);
        return;
    }
    facts[name + " index"] = media::content_fact(voctree::index_file(clip));
    for (const voctree::ClipSegment& segment : voctree::read_clip_index(clip).segments) {
        const bool there = std::filesystem::exists(segment.file);
        facts[fmt::format("{} at {}", name, segment.first)] = there ? media::content_fact(segment.file) : "missing";
    }
}

void add_layer_facts(media::RenderFacts& facts, const std::string& name, const std::filesystem::path& layer) {
    if (!std::filesystem::is_directory(layer)) {
        facts[name] = media::content_fact(layer);
        return;
    }
    for (const auto& file : std::filesystem::directory_iterator(layer))
        if (file.path().extension() == ".nvpaint")
            facts[name + " in " + file.path().stem().string()] = media::content_fact(file.path());
}

media::Image pass_image(const RenderOptions& options, const render::FrameRenderer& renderer, uint32_t i) {
    const render::FramePass& pass = *render::find_frame_pass(options.pass);
    const render::PassValues values = pass.read(renderer);
    const auto range = render::range_of(values);
    const std::string text = range ? fmt::format("image {}: {} from {:.6g} (dark) to {:.6g} (bright), in {}\n", i,
                                                 pass.name, range->first, range->second, pass.unit)
                                   : fmt::format("image {}: {} holds nothing\n", i, pass.name);
    if (options.json)
        say("{}", text);
    else
        tell("{}", text);
    return render::colour_mapped(values, range.value_or(std::pair(0.0f, 1.0f)));
}

namespace {

// The sides of a video are even numbers.
media::ImageSize written_size(const media::ImageOutput& output, media::ImageSize size) {
    if (output.kind != media::ImageOutput::Kind::kVideo) return size;
    return {media::video_side(size.width), media::video_side(size.height)};
}

}  // namespace

RenderTotals planned(const RenderOptions& options, const media::ImageOutput& output, uint32_t images,
                     media::ImageSize size, double fps) {
    expect_enough_images(part_number(options.part, ranks_of_environment()), images);
    expect_new_images(options, output, images);
    return {images, 0, written_size(output, size), fps};
}

RenderTotals conclude_part(const RenderOptions& options, const RenderPart& part, media::ImageSize size, double fps) {
    if (const std::string text = part.join_if_complete(); !text.empty()) say("{}: {}\n", options.output, text);
    return {part.end() - part.first(), 0, written_size(part.output(), size), fps};
}

namespace {

// Draws the image; where the device is lost, the error says which image it was.
FrameTimes named_loss(uint32_t i, const std::function<FrameTimes(uint32_t)>& render) {
    try {
        return render(i);
    } catch (const gpu::VulkanError& error) {
        if (!error.device_lost()) throw;
        throw gpu::VulkanError(error.result,
                               fmt::format("image {}: {}; look at the driver's messages (dmesg), or choose "
                                           "another device by --device",
                                           i, message_of(error)));
    }
}

}  // namespace

RenderTotals render_images(const RenderOptions& options, media::ImageSize size, double fps, const RenderPart& part,
                           media::ImageSink& sink, const gpu::Device& device,
                           const std::function<FrameTimes(uint32_t)>& render) {
    const bool video = part.output().kind == media::ImageOutput::Kind::kVideo;
    size_t rendered = 0;
    double seconds = 0;
    Progress progress("render", part.end() - part.first());
    for (uint32_t i = part.first(); i < part.end(); ++i) {
        if (stop_requested())
            throw RuntimeFailure(fmt::format("{}: stopped before the end; {}", options.output,
                                             sink.resumable() ? "--resume goes on with it"
                                             : video ? "begin a video with --resume to be able to go on with it"
                                                     : "begin it anew"));
        if (!sink.has(i)) {
            std::optional<gpu::FrameCapture> capture;
            if (options.capture && rendered == 0) capture.emplace(device);
            const FrameTimes times = named_loss(i, render);
            if (capture) say("captured image {}: {}\n", i, capture->finish());
            ++rendered;
            seconds += times.milliseconds / 1000;
            if (trace_wanted()) say("image {}: {}\n", i, pass_times_text(times.passes));
        }
        progress.update(i + 1 - part.first());
    }
    sink.finish(part.end(), [&] { part.finish_whole(); });
    if (sink.removed() > 0)
        say("removed {} images of an earlier, longer render behind image {}\n", sink.removed(), part.end() - 1);
    RenderTotals totals = conclude_part(options, part, size, fps);
    totals.rendered = rendered;
    totals.seconds = seconds;
    totals.rays =
        static_cast<double>(rendered) * size.width * size.height * std::pow(options.scale * samples_of(options), 2);
    return totals;
}

void add_render(Command app, CommonOptions& common) {
    Command verb = app.add_verb("render", "Render a clip or a stage to a free-viewpoint video or to images");
    const auto options = std::make_shared<RenderOptions>();
    add_options(verb, *options);
    verb.footer(
        {"NEUVV_TRACE=1 prints the time of each pass; of a stage not on software devices, whose "
         "clocks miss the set.\n",
         kDeviceHelp, kExamplesHead,
         "  neuvv render work/performer.nvv -o work/turn.mp4\n"
         "  neuvv render work/performer.nvv -o work/still.png --frames 1.5 --size 1280x720\n"
         "  neuvv render work/performer.nvv -o work/seen.mp4 --camera work/performer/transforms_test.json "
         "--size 480x480\n"
         "  neuvv render work/performer.nvv -o work/shot/out_%04d.exr --camera path.json --resume\n"
         "  neuvv render work/performer.nvv -o work/keyed.mov --size 1280x720\n"
         "  neuvv render work/performer.nvv -o work/comp.exr --layers rgba,depth,ids,deep --frames 0\n"
         "  neuvv render work/performer.nvv -o work/depth.mp4 --depth --frames 0\n"
         "  neuvv render work/performer.nvv -o work/half.mp4 --part 1/2\n"
         "  neuvv render work/performer.nvv -o work/half.mp4 --part 2/2\n"
         "  mpirun --bind-to none -n 2 neuvv render work/performer.nvv -o work/turn.mp4\n"
         "  neuvv render work/performer.nvv -o work/cost.png --cost --cost-max 64 --frames 0\n"
         "  neuvv render --pass list\n"
         "  neuvv render work/performer.nvv -o work/near.png --pass tile-near --frames 0\n"
         "  neuvv stage new work/show.gltf\n"
         "  neuvv stage add work/show.gltf work/performer.nvv\n"
         "  neuvv render work/show.gltf -o work/show.mp4 --camera camera --size 640x360"});
    verb.callback([options, &common] { run(*options, common); });
}

}  // namespace neuvv::tools

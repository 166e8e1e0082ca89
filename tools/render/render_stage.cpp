// neuvv render of a stage.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "base/output_path.h"
#include "interchange/camera/camera_path_file.h"
#include "media/image_sink.h"
#include "render/clips/light_status.h"
#include "render/clips/stage_renderer.h"
#include "stage/sound/stage_sound.h"
#include "tools/render/render.h"
#include "tools/render/render_layers.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/stage/stage_verbs.h"
#include "tools/view_path.h"

namespace neuvv::tools {

namespace {

constexpr double kMaxImages = 1e6;
constexpr double kMinOrbitSeconds = 4;

struct StagePlan {
    media::ImageOutput output;
    ExrLayers layers;
    render::ResolveSettings resolve;
    stage::Stage stage;
    std::optional<stage::CameraPath> path;  // without: the orbit, or where that is empty a camera of the stage
    bool is_stage_path = false;             // whether the path is the stage's own, in stage time
    std::vector<ViewStep> orbit;
    double first_s = 0, fps = 25;
    uint32_t images = 1;
    media::ImageSize size;

    double time_s(uint32_t i) const { return first_s + i / fps; }
};

// "A:B", "A:", ":B" or "A", seconds of the stage.
std::pair<double, double> time_range(const std::string& text, double duration_s) {
    const auto number = [&](const std::string& part, double fallback) {
        if (part.empty()) return fallback;
        char* end = nullptr;
        const double value = std::strtod(part.c_str(), &end);
        if (*end != '\0' || !(std::abs(value) <= stage::kMaxStageSeconds))
            throw InputError("--time", text, fmt::format("\"{}\" is no time in seconds", part),
                             fmt::format("give FROM:TO within {} s", stage::kMaxStageSeconds));
        return value;
    };
    const size_t colon = text.find(':');
    if (text.empty()) return {0, duration_s};
    if (colon == std::string::npos) return {number(text, 0), number(text, 0)};
    const std::pair<double, double> range{number(text.substr(0, colon), 0), number(text.substr(colon + 1), duration_s)};
    if (range.second < range.first) throw InputError("--time", text, "ends before it begins");
    return range;
}

void expect_stage_options(const RenderOptions& options) {
    if (!options.frames.empty())
        throw InputError("--frames", options.frames, "is for clips", "choose --time of a stage, in seconds");
    if (!options.paint.empty())
        throw InputError("--paint", options.paint[0], "is for clips", "paint performers with `neuvv stage paint`");
    if (options.direct) throw InputError("--direct", "", "is for clips", "leave it out, or choose --slice-budget 0");
}

void override_settings(const RenderOptions& options, stage::Stage& stage) {
    stage.settings.blend = options.blend.value_or(stage.settings.blend);
    stage.settings.shadows = options.shadows.value_or(stage.settings.shadows);
    stage.settings.falloff = options.falloff.value_or(stage.settings.falloff);
}

// One turn around the performers.
std::vector<ViewStep> orbit_of(const StagePlan& plan) {
    const double seconds = std::max(kMinOrbitSeconds, plan.images / plan.fps);
    Playback playback;  // of a clip that would last as long
    playback.clip_fps = playback.output_fps = plan.fps;
    playback.range = {0, std::max(1.0, std::round(seconds * plan.fps)) - 1};
    return orbit_path(stage::performers_box(plan.stage, stage::stage_at(plan.stage, plan.first_s)), playback,
                      plan.size);
}

// The camera at the time of `evaluated`; of the orbit, that of the nearest image.
stage::Camera camera_of(const RenderOptions& options, const StagePlan& plan, const stage::EvaluatedStage& evaluated) {
    const media::ImageSize size = plan.size;
    if (plan.path) return stage::camera_at(*plan.path, evaluated.time_s, size.width, size.height);
    if (!plan.orbit.empty()) {
        const auto image = static_cast<size_t>(std::llround((evaluated.time_s - plan.first_s) * plan.fps));
        return plan.orbit[image % plan.orbit.size()].camera;
    }
    return stage::camera_of(plan.stage, options.camera, evaluated, size.width, size.height);
}

// Sets the distances that images of depth show as white and black: the nearest and the farthest of any performer,
// sampled at up to 32 images.
void set_depth_range(const RenderOptions& options, StagePlan& plan) {
    constexpr uint32_t kMaxSamples = 32;
    const uint32_t samples = std::min(kMaxSamples, plan.images);
    double nearest = INFINITY, farthest = 0;
    for (uint32_t k = 0; k < samples; ++k) {
        const auto i = static_cast<uint32_t>(uint64_t{plan.images} * k / samples);
        const stage::EvaluatedStage evaluated = stage::stage_at(plan.stage, plan.time_s(i));
        const auto [near, far] =
            depth_range({{camera_of(options, plan, evaluated), 0}}, stage::performers_box(plan.stage, evaluated));
        nearest = std::min(nearest, near);
        farthest = std::max(farthest, far);
    }
    plan.resolve.depth_near_m = static_cast<float>(nearest);
    plan.resolve.depth_far_m = static_cast<float>(farthest);
}

// The images of --time, else of the whole path of a file, else of the whole stage.
void plan_time(const RenderOptions& options, StagePlan& plan) {
    if (plan.path && !plan.is_stage_path && options.time.empty()) {
        plan.images = static_cast<uint32_t>(path_images(*plan.path, plan.fps, plan.stage.duration_s));
        return;
    }
    const bool moves = plan.path && !plan.is_stage_path && plan.path->keys.size() > 1;
    const auto [first_s, last_s] = time_range(options.time, moves ? plan.path->duration_s : plan.stage.duration_s);
    expect_time_on_stage(plan.stage, "--time", first_s);
    const double images = std::max(1.0, std::round((last_s - first_s) * plan.fps));
    if (images > kMaxImages)
        throw InputError("--time", options.time, fmt::format("makes more than {} images", kMaxImages),
                         "choose less of it, or a lower --fps");
    plan.first_s = first_s;
    plan.images = static_cast<uint32_t>(images);
}

// A stage may have more lights than the renderer takes; that is no error of the file, but the user should know.
void warn_of_light_limits(const stage::Stage& stage, const stage::EvaluatedStage& evaluated) {
    const std::vector<render::LightStatus> lights = render::light_statuses(stage, evaluated);
    const std::string file = stage.file.path.string();
    size_t shining = 0, casting = 0, shadowless = 0;
    for (const render::LightStatus& light : lights) {
        shining += light.shines;
        casting += light.casts_shadow;
        shadowless += light.shines && !light.text.empty();
    }
    if (shining < lights.size()) say("{}: has {} lights, of which the first {} shine\n", file, lights.size(), shining);
    if (stage.settings.shadows && shadowless > 0)
        say("{}: {} of its lights would cast shadows, of which the first {} do\n", file, casting + shadowless, casting);
}

StagePlan plan_stage(const RenderOptions& options) {
    expect_stage_options(options);
    StagePlan plan;
    plan.output = media::parse_output(options.output);
    expect_fitting_output(plan.output, options);
    prepare_output_file("--output", plan.output.path);
    plan.layers = parse_layers(options.layers);
    plan.output.has_deep = plan.layers.deep;
    const media::ImageSize given_size = options.size.empty() ? media::ImageSize{} : parse_size(options.size);
    plan.stage = stage::load_stage(options.scene);
    say_notes(options.scene, plan.stage.scene.notes);
    override_settings(options, plan.stage);
    if (plan.layers.needs_segments() && plan.stage.settings.blend != stage::StageBlend::kExact)
        throw InputError("--layers", options.layers, "need performers that are blended exactly", "add --blend exact");
    plan.fps = checked_fps(options, 0, plan.stage.fps);
    if (names_camera_path(options.camera)) {
        plan.path = interchange::read_camera_path(options.camera, plan.fps, interchange::frame_of(plan.stage));
        plan.fps = checked_fps(options, plan.path->fps, plan.stage.fps);
    }
    if (options.camera == kStagePath && plan.stage.settings.camera_path) {
        plan.path = plan.stage.settings.camera_path;
        plan.is_stage_path = true;
    }
    plan_time(options, plan);
    const bool still = plan.output.kind == media::ImageOutput::Kind::kImage;
    const bool one_view = !plan.path || plan.is_stage_path || plan.path->keys.size() == 1;
    if (still && options.time.empty() && one_view) plan.images = 1;
    expect_fitting_output(plan.output, plan.images);
    plan.size = given_size.width                ? given_size
                : plan.path && plan.path->width ? media::ImageSize{plan.path->width, plan.path->height}
                                                : kStageSize;
    plan.resolve = resolve_settings(options, plan.output);
    if (options.background.empty()) plan.resolve.background = glm::vec4(plan.stage.settings.background, 1);
    const stage::EvaluatedStage first = stage::stage_at(plan.stage, plan.first_s);
    if (!plan.path && (options.orbit || (!stage::has_camera(first) && options.camera.empty())))
        plan.orbit = orbit_of(plan);
    camera_of(options, plan, first);  // throws InputError where the stage has no such camera
    warn_of_light_limits(plan.stage, first);
    set_depth_range(options, plan);
    return plan;
}

// What the images depend on: options, and the content of all files of the stage.
media::RenderFacts stage_facts(const RenderOptions& options, const StagePlan& plan) {
    media::RenderFacts facts = render_facts(options, plan.fps, plan.size, plan.images);
    facts["stage"] = media::content_fact(options.scene);
    for (const stage::StageClip& clip : plan.stage.clips)
        add_clip_facts(facts, "clip " + clip.path.string(), clip.path);
    if (const auto& environment = plan.stage.settings.environment)
        facts["environment"] =
            media::content_fact(stage::file_of_uri(plan.stage.file, environment->uri, "environment"));
    for (const char* kind : {"buffers", "images"})
        if (const nlohmann::ordered_json* list = plan.stage.file.json.find(kind))
            for (const auto& entry : *list) {
                const std::string uri = entry.value("uri", "");
                if (!uri.empty() && uri.rfind("data:", 0) != 0)
                    facts[std::string(kind) + " " + uri] =
                        media::content_fact(stage::file_of_uri(plan.stage.file, uri, kind));
            }
    for (const stage::StagePerformer& performer : plan.stage.performers)
        for (const stage::PaintLayer& layer : performer.settings.paint)
            add_layer_facts(facts, "paint " + layer.uri,
                            stage::file_of_uri(plan.stage.file, layer.uri, performer.name));
    facts["--camera"] = plan.path && !plan.is_stage_path ? media::content_fact(options.camera)
                        : options.orbit                  ? "orbit"
                                                         : options.camera;
    facts["--time"] = fmt::format("{}", plan.first_s);
    facts["--blend"] = stage::kStageBlendNames[static_cast<size_t>(plan.stage.settings.blend)];
    facts["--shadows"] = fmt::format("{}", plan.stage.settings.shadows);
    facts["--falloff"] = fmt::format("{}", plan.stage.settings.falloff);
    return facts;
}

FrameTimes render_image(render::StageRenderer& renderer, const RenderOptions& options, const StagePlan& plan,
                        uint32_t i, media::ImageSink& sink) {
    const stage::EvaluatedStage evaluated = stage::stage_at(plan.stage, plan.time_s(i));
    const stage::Camera camera = camera_of(options, plan, evaluated);
    renderer.show(evaluated, options.background.empty());
    say_not_shown(renderer.take_problems());
    render::FrameSettings settings = renderer.settings_at(evaluated);
    settings.scale = options.scale;
    settings.far_levels = options.far_levels.value_or(true);
    settings.resolve = plan.resolve;
    media::Image image = renderer.frames().render(camera, settings);
    const FrameTimes times = times_of(renderer.frames());
    if (!sink.exr()) {
        sink.add(i, options.pass.empty() ? std::move(image) : pass_image(options, renderer.frames(), i));
        return times;
    }
    std::vector<std::string> names;
    for (const stage::StagePerformer& performer : plan.stage.performers) names.push_back(performer.name);
    const render::SetRays set = renderer.set_rays();
    add_layers(sink, i, plan.layers, renderer.linear_image_of(camera, set, plan.resolve.background), renderer.frames(),
               camera, settings, names, set);
    return times;
}

}  // namespace

RenderTotals render_stage(const RenderOptions& options, const CommonOptions& common) {
    const StagePlan plan = plan_stage(options);
    if (options.plan) return planned(options, plan.output, plan.images, plan.size, plan.fps);
    const media::RenderFacts facts = stage_facts(options, plan);
    std::optional<stage::StageSound> sound;
    if (plan.output.kind == media::ImageOutput::Kind::kVideo)
        sound.emplace(plan.stage, plan.first_s, [&](const stage::EvaluatedStage& evaluated) {
            return camera_of(options, plan, evaluated).world_from_camera;
        });
    expect_new_images(options, plan.output, plan.images);
    RenderPart part(part_number(options.part, ranks_of_environment()), plan.output, facts, plan.images, options.resume);
    if (sound && !sound->is_silent()) {
        media::expect_sound_encoder();
        part.finish_with([&](const std::filesystem::path& video) {
            media::add_sound(video, [&](auto& samples) { sound->next(samples); });
        });
    }
    if (options.resume && part.is_there()) return conclude_part(options, part, plan.size, plan.fps);
    media::ImageSink sink(part.output(), plan.size, plan.fps, facts, options.resume, part.range());
    const gpu::Device device(device_of(common));
    render::FrameCapacity capacity{plan.size.width, plan.size.height, samples_of(options)};
    capacity.slice_budget = bytes_of_mebibytes(options.slice_budget_mb);
    Progress reading("read");
    const auto read = [&](size_t done, size_t of) {
        reading.set_total(of);
        reading.update(done);
    };
    render::StageRenderer renderer(device, plan.stage, render::StageLoader(device).load(plan.stage, read), capacity);
    reading.finish();
    say_not_shown(renderer.take_problems());
    return render_images(options, plan.size, plan.fps, part, sink, device,
                         [&](uint32_t i) { return render_image(renderer, options, plan, i, sink); });
}

}  // namespace neuvv::tools

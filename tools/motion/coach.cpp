// neuvv coach: a recorded trainee against the trainer of a stage, as a video.
#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "base/platform.h"
#include "base/text.h"
#include "coach/trainer.h"
#include "editor/open_file.h"
#include "media/image_sink.h"
#include "motion/live/pose_source.h"
#include "tools/motion/coach_drawing.h"
#include "tools/motion/motion_page.h"
#include "tools/motion/skeleton_verbs.h"
#include "tools/options.h"
#include "tools/report.h"
#include "tools/results.h"
#include "tools/say.h"

namespace neuvv::tools {

namespace {

constexpr double kFlight_s = 0.6;   // in which the camera comes near to a better view
constexpr double kMostStretch = 6;  // of the stage's duration, where the clip waits for the trainee
constexpr double kVerticalAngle_deg = 45;

struct CoachOptions {
    std::string stage, against, output, performer, camera, size = "960x540", html, leave_out;
    std::optional<coach::Mode> mode;
    std::optional<bool> far_levels;  // nothing: on
    bool mirror = false, no_ghost = false, no_arrows = false, json = false;
    double speed = 1;
    uint32_t samples = kDefaultSamples;
};

// What is shown: a trainer on a stage, a camera, and how the video runs.
struct CoachScene {
    stage::Stage stage;
    coach::Trainer trainer;
    media::ImageOutput output;
    media::ImageSize size;

    const stage::EvaluatedPerformer& performer(const stage::EvaluatedStage& evaluated) const {
        return evaluated.performers[trainer.performer];
    }
};

// A camera that looks at the trainer from where the errors are seen best, and flies there.
class CoachCamera {
  public:
    CoachCamera(const coach::Coach& coach, media::ImageSize size) : coach_(coach), size_(size) {
        const motion::Pose& pose = coach.trainer().frames[0];
        const auto place = [&pose](motion::Joint joint) { return motion::at(pose, joint).position; };
        centre_ = place(motion::Joint::kPelvis);
        // In front of the trainer, a little above.
        const glm::dvec3 across = place(motion::Joint::kLeftHip) - place(motion::Joint::kRightHip);
        const glm::dvec3 ahead = glm::cross(across, glm::dvec3(0, 1, 0));
        direction_ = glm::length(ahead) > 1e-6 ? glm::normalize(glm::normalize(ahead) + glm::dvec3(0, 0.1, 0))
                                               : glm::dvec3(0, 0, 1);
    }

    // The camera of the next image, `step_s` after the last one, in the world.
    stage::Camera next(double step_s, const glm::dmat4& world_from_performer) {
        const double share = 1 - std::exp(-step_s / kFlight_s);
        const glm::dvec3 pelvis = coach_.centre();
        centre_ = glm::mix(centre_, pelvis, share);
        if (const auto eye = coach_.best_eye()) {
            const glm::dvec3 wanted = glm::normalize(*eye - pelvis);
            // From behind, a flight goes around the body, not through it.
            const glm::dvec3 between =
                glm::dot(wanted, direction_) < -0.99 ? glm::dvec3(wanted.z, 0, -wanted.x) : wanted;
            direction_ = glm::normalize(glm::mix(direction_, between, share));
        }
        const auto world = [&](const glm::dvec3& p) { return glm::dvec3(world_from_performer * glm::dvec4(p, 1)); };
        const glm::dvec3 eye = world(centre_ + coach::kViewDistance * coach_.height() * direction_);
        stage::Camera camera;
        camera.width = size_.width;
        camera.height = size_.height;
        camera.cx = 0.5 * size_.width;
        camera.cy = 0.5 * size_.height;
        camera.fx = camera.fy = 0.5 * size_.height / std::tan(0.5 * glm::radians(kVerticalAngle_deg));
        camera.world_from_camera = glm::inverse(glm::lookAt(eye, world(centre_), glm::dvec3(0, 1, 0)));
        return camera;
    }

  private:
    const coach::Coach& coach_;
    media::ImageSize size_;
    glm::dvec3 centre_{0}, direction_{0, 0, 1};
};

coach::CoachSettings coach_settings(const CoachOptions& options) {
    coach::CoachSettings settings;
    settings.mode = options.mode.value_or(coach::Mode::kPerform);
    settings.mirrored = options.mirror;
    settings.speed = options.speed;
    settings.ghost = !options.no_ghost;
    settings.arrows = !options.no_arrows;
    settings.compare.counted = counted_limbs(options.leave_out);
    return settings;
}

CoachScene read_coach_scene(const CoachOptions& options) {
    CoachScene scene;
    scene.output = media::parse_output(options.output);
    if (scene.output.exr)
        throw InputError("--output", options.output, "is not for linear images", "write .mp4 or .png");
    if (scene.output.kind == media::ImageOutput::Kind::kImage)
        throw InputError("--output", options.output, "is one image",
                         "write out.mp4, or numbered images as out_%04d.png");
    if (!options.html.empty() && options.mode.value_or(coach::Mode::kPerform) != coach::Mode::kPerform)
        throw InputError("--html", options.html, "is a report of a performance", "leave --mode out");
    if (options.json && options.mode.value_or(coach::Mode::kPerform) != coach::Mode::kPerform)
        throw InputError("--json", "", "is about a performance", "leave --mode out");
    prepare_images("--output", scene.output, 0, 1);
    if (!options.html.empty()) prepare_result("--html", options.html, kHtmlEndings);
    scene.size = parse_size(options.size);
    scene.stage = stage::make_stage(editor::open_document(options.stage).file);
    scene.trainer = coach::read_trainer(scene.stage, options.performer);
    return scene;
}

// Renders the performance until the stage has ended; returns the number of images.
uint32_t render_performance(const CoachScene& scene, const CoachOptions& options, coach::Coach& coach,
                            motion::PoseSource& trainee, const gpu::Device& device) {
    const double fps = scene.stage.fps, step_s = 1 / fps;
    render::StageRenderer renderer(device, scene.stage, render::StageLoader(device).load(scene.stage),
                                   {scene.size.width, scene.size.height, options.samples});
    media::ImageSink sink(scene.output, scene.size, fps, {}, false);
    CoachCamera flying(coach, scene.size);
    const double most_s = kMostStretch * scene.stage.duration_s / options.speed;
    Progress progress("coach", static_cast<uint64_t>(std::ceil(scene.stage.duration_s * fps / options.speed)));
    uint32_t images = 0;
    for (double stage_s = 0; stage_s < scene.stage.duration_s - 1e-9 && images * step_s < most_s; ++images) {
        if (stop_requested()) throw RuntimeFailure(options.output + ": stopped before the end");
        const double now_s = images * step_s;
        const stage::EvaluatedStage evaluated = stage::stage_at(scene.stage, stage_s);
        const stage::EvaluatedPerformer& performer = scene.performer(evaluated);
        coach.update(trainee.newest(now_s), now_s, coach::clip_time_of(scene.stage, performer));
        stage::Camera camera = flying.next(step_s, performer.world_from_performer);
        if (!options.camera.empty())
            camera = stage::camera_of(scene.stage, options.camera, evaluated, scene.size.width, scene.size.height);
        renderer.show(evaluated);
        say_not_shown(renderer.take_problems());
        render::FrameSettings settings = renderer.settings_at(evaluated, {scene.trainer.performer, coach.highlight()});
        settings.far_levels = options.far_levels.value_or(true);
        media::Image image = renderer.frames().render(camera, settings);
        draw_guide(image, camera, performer.world_from_performer, coach);
        draw_remarks(image, coach);
        sink.add(images, std::move(image));
        progress.update(images + 1);
        stage_s += coach.clip_speed() * step_s;
    }
    sink.finish(images);
    return images;
}

void run_coach(const CoachOptions& options, const CommonOptions& common) {
    const CoachScene scene = read_coach_scene(options);
    const std::unique_ptr<motion::PoseSource> trainee = motion::open_pose_source(options.against);
    coach::Coach coach(scene.trainer.skeleton, coach_settings(options));
    catch_stop_signals();
    const gpu::Device device(common.device);
    const uint32_t images = render_performance(scene, options, coach, *trainee, device);
    if (coach.recorded().frames.empty()) {
        if (coach.settings().mode == coach::Mode::kPerform)
            throw InputError(options.against, "", "has no pose while the stage lasts", "name a longer motion");
        tell("{}: {} images\n", options.output, images);
        return;
    }
    const motion::CompareOptions& compare = coach.settings().compare;
    const motion::Comparison found = motion::compare(coach.shown_to_recorded(), coach.recorded(), compare);
    if (!options.html.empty())
        write_text_file(options.html, motion_page({options.stage, options.against}, coach.shown_to_recorded(),
                                                  coach.recorded(), found, compare.tolerances));
    if (!options.html.empty()) say("wrote {}\n", options.html);
    if (options.json) {
        tell("{}", json_text(comparison_json(found)));
        return;
    }
    tell("{}: {} images\n", options.output, images);
    print_comparison(found);
}

}  // namespace

void add_coach(Command app, CommonOptions& common) {
    Command verb = app.add_verb("coach", "Show what a trainee does otherwise than a performer, as a video");
    const auto options = std::make_shared<CoachOptions>();
    verb.add_option("STAGE", options->stage, "A stage or a .nvv whose performer has a skeleton (neuvv skeleton)")
        .required();
    verb.add_option("--against", options->against,
                    "The trainee's motion: a .skeleton.glb, an animated .glb, a .bvh, a .trc, or .jsonl")
        .required();
    verb.add_option("-o,--output", options->output, "out.mp4, or out_%04d.png").required();
    verb.add_option("--performer", options->performer, "The trainer's name (default: the first with a skeleton)");
    verb.add_option("--camera", options->camera,
                    "A camera of the stage (default: one that flies to where errors are seen best)");
    add_choice(verb, "--mode", options->mode, coach::kModeNames,
               "watch: only the clip; follow: the clip waits for the trainee; perform (default): it does not");
    verb.add_flag("--mirror", options->mirror, "The trainee does with the left what the trainer does with the right");
    verb.add_option("--leave-out", options->leave_out, "Limbs that do not count: \"head,left arm\"");
    verb.add_option("--speed", options->speed, "Of the clip").number_between(0.1, 2).show_default();
    verb.add_flag("--no-ghost", options->no_ghost, "Do not draw the trainee's skeleton");
    verb.add_flag("--no-arrows", options->no_arrows, "Do not draw where joints should be");
    verb.add_option("--html", options->html, "A report with curves and stick figures");
    verb.add_flag("--json", options->json, "Print JSON");
    verb.add_option("--size", options->size, "Of the images, WxH pixels").show_default();
    add_samples_option(verb, options->samples);
    add_far_levels_option(verb, options->far_levels);
    verb.footer(
        {"\nThe trainee's body parts that are off are red on the trainer; the trainee is a ghost of bones inside, and "
         "arrows\n"
         "lead to where joints should be. `neuvv view` and `neuvv xr` show the same while somebody performs.\n\n"
         "Example, after `tools/demo`:\n"
         "  neuvv coach demo/performer.nvv --against tools/performer/trainee.glb -o work/coach.mp4 --html "
         "work/report.html\n",
         kDeviceHelp});
    verb.callback([options, &common] { run_coach(*options, common); });
}

}  // namespace neuvv::tools

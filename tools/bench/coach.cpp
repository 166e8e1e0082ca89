// neuvv-bench coach: what a trainee adds to a frame, from the packet with a pose to the red limb.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/platform.h"
#include "coach/guide.h"
#include "coach/trainer.h"
#include "editor/open_file.h"
#include "motion/live/pose_source.h"
#include "motion/skeleton/skeleton_file.h"
#include "render/clips/stage_renderer.h"
#include "tools/bench/measure.h"
#include "tools/bench/vmc_sender.h"
#include "tools/options.h"
#include "tools/report.h"

namespace neuvv::bench {

namespace {

constexpr double kPacketRate_hz = 60;
constexpr double kBar_ms = 20;  // of all that a trainee adds
constexpr double kViewAngle_deg = 45;

struct CoachOptions : BenchOptions {
    CoachOptions() { size = "960x540"; }
    std::string against, performer;
    uint32_t frames = 120, packets = 0;
};

// A trainer on a stage, and a trainee who sends packets to a port.
struct Lesson {
    explicit Lesson(const CoachOptions& options)
        : stage(stage::make_stage(editor::open_document(options.scene).file)),
          trainer(coach::read_trainer(stage, options.performer)),
          trainee(options.against.empty() ? mirror_image(trainer.skeleton) : motion::read_skeleton(options.against)),
          lengths(motion::bone_lengths(trainee)),
          source(motion::open_pose_source("vmc:0")),
          sender(source->name()),
          coach(trainer.skeleton, {.mode = coach::Mode::kPerform}) {}

    // Limbs that are red as often as this are the most work.
    static motion::SkeletonClip mirror_image(motion::SkeletonClip clip) {
        for (motion::Pose& pose : clip.frames) pose = motion::mirrored(pose);
        return clip;
    }
    // The trainee begins anew with the clip.
    void send_pose(double now_s) const {
        const double frame = std::fmod(now_s, stage.duration_s) * trainee.fps;
        sender.send(vmc_packet(motion::pose_at(trainee, frame), lengths));
    }
    // The stage at the newest of its frames.
    stage::EvaluatedStage shown(double now_s) const {
        const double stage_s = std::fmod(now_s, stage.duration_s);
        return stage::stage_at(stage, std::floor(stage_s * stage.fps + 1e-6) / stage.fps);
    }
    const stage::EvaluatedPerformer& performer(const stage::EvaluatedStage& evaluated) const {
        return evaluated.performers[trainer.performer];
    }
    double clip_time(const stage::EvaluatedStage& evaluated) const {
        return coach::clip_time_of(stage, performer(evaluated));
    }

    stage::Stage stage;
    coach::Trainer trainer;
    motion::SkeletonClip trainee;
    std::array<double, motion::kJoints> lengths;
    std::unique_ptr<motion::PoseSource> source;
    VmcSender sender;
    coach::Coach coach;
};

// Milliseconds of each frame.
struct Steps {
    std::vector<double> packet, update, compare, view, show;  // on the host; compare and view are parts of update
    std::vector<double> plain, red, added;                    // the frame without and with its highlight; red − plain
    std::vector<double> all;                                  // that a trainee adds: on the host, and to the frame
    std::vector<double> bind, tint;                           // passes of the latter, on the device
    uint32_t red_frames = 0;                                  // in which a limb was red
};

template <typename Call>
void time_step(std::vector<double>& steps, Call&& call) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    call();
    steps.push_back(milliseconds_since(begin));
}

// What Coach::update does, part by part, to be timed.
struct CoachParts {
    explicit CoachParts(const Lesson& lesson) : comparison(lesson.trainer.skeleton, lesson.coach.settings().compare) {}

    motion::LiveComparison comparison;
    coach::ViewChooser chooser;
};

void time_host_steps(Lesson& lesson, CoachParts& parts, double now_s, double clip_s, Steps& steps) {
    lesson.send_pose(now_s);
    std::optional<motion::TimedPose> pose;
    time_step(steps.packet, [&] { pose = lesson.source->newest(now_s); });
    if (!pose) throw RuntimeFailure("no pose came of a packet: " + lesson.source->state().first_error);
    time_step(steps.update, [&] { lesson.coach.update(pose, now_s, clip_s); });
    time_step(steps.compare, [&] { parts.comparison.add(pose->pose, pose->time_s, clip_s); });
    time_step(steps.view, [&] {
        const std::vector<coach::JointError> errors = lesson.coach.errors();
        parts.chooser.choose(errors, errors.empty() ? std::vector<coach::BodyBone>{} : lesson.coach.body(),
                             lesson.coach.centre(), coach::kViewDistance * lesson.coach.height(), 1 / lesson.stage.fps);
    });
    time_step(steps.show, [&] {
        lesson.coach.highlight();
        coach::guide_of(lesson.coach);
    });
    steps.red_frames += std::ranges::max(lesson.coach.red()) > 0;
}

// From the front, as far away as the coach looks.
stage::Camera front_camera(const Lesson& lesson, const stage::EvaluatedStage& evaluated, media::ImageSize size) {
    const auto world = [&](const glm::dvec3& point) {
        return glm::dvec3(lesson.performer(evaluated).world_from_performer * glm::dvec4(point, 1));
    };
    const glm::dvec3 centre = lesson.coach.centre();
    const glm::dvec3 eye = world(centre + coach::kViewDistance * lesson.coach.height() * glm::dvec3(0, 0, 1));
    stage::Camera camera;
    camera.width = size.width;
    camera.height = size.height;
    camera.cx = 0.5 * size.width;
    camera.cy = 0.5 * size.height;
    camera.fx = camera.fy = 0.5 * size.height / std::tan(0.5 * glm::radians(kViewAngle_deg));
    camera.world_from_camera = glm::inverse(glm::lookAt(eye, world(centre), glm::dvec3(0, 1, 0)));
    return camera;
}

// Draws the frame once to build its slice, then with and without the highlight, in an order that alternates.
void time_frame(const Lesson& lesson, render::StageRenderer& renderer, const stage::EvaluatedStage& evaluated,
                const stage::Camera& camera, bool red_first, Steps& steps) {
    renderer.show(evaluated);
    const render::FrameSettings plain = renderer.settings_at(evaluated);
    const render::FrameSettings red =
        renderer.settings_at(evaluated, {lesson.trainer.performer, lesson.coach.highlight()});
    const auto milliseconds_of = [&](const render::FrameSettings& settings) {
        renderer.frames().draw({&camera, 1}, settings);
        return renderer.frames().milliseconds();
    };
    const auto draw_red = [&] {
        steps.red.push_back(milliseconds_of(red));
        for (const gpu::PassTime& pass : renderer.frames().pass_times()) {
            if (pass.name == "bind bones") steps.bind.push_back(pass.milliseconds);
            if (pass.name == "highlight") steps.tint.push_back(pass.milliseconds);
        }
    };
    milliseconds_of(plain);
    if (red_first) draw_red();
    steps.plain.push_back(milliseconds_of(plain));
    if (!red_first) draw_red();
    steps.added.push_back(steps.red.back() - steps.plain.back());
}

Steps measure_steps(const gpu::Device& device, Lesson& lesson, const CoachOptions& options) {
    const media::ImageSize size = tools::parse_size(options.size);
    render::StageRenderer renderer(device, lesson.stage, render::StageLoader(device).load(lesson.stage),
                                   capacity_of(options));
    CoachParts parts(lesson);
    Steps steps;
    tools::Progress progress("frames", options.frames);
    constexpr uint32_t kWarmUp = 8;  // frames until pipelines and the body of the packets are known
    for (uint32_t i = 0; i < options.frames + kWarmUp && !stop_requested(); ++i) {
        if (i == kWarmUp) steps = {};
        const double now_s = i / lesson.stage.fps;
        const stage::EvaluatedStage evaluated = lesson.shown(now_s);
        time_host_steps(lesson, parts, now_s, lesson.clip_time(evaluated), steps);
        time_frame(lesson, renderer, evaluated, front_camera(lesson, evaluated, size), i % 2 == 0, steps);
        steps.all.push_back(steps.packet.back() + steps.update.back() + steps.show.back() + steps.added.back());
        if (i >= kWarmUp) progress.update(i - kWarmUp + 1);
    }
    return steps;
}

// Bytes of the heap that are in use after the first tenth of the packets, and at the end.
struct HeapGrowth {
    size_t early = 0, late = 0;
};

HeapGrowth measure_heap(Lesson& lesson, uint32_t packets) {
    HeapGrowth heap;
    tools::Progress progress("packets", packets);
    for (uint32_t i = 0; i < packets && !stop_requested(); ++i) {
        const double now_s = i / kPacketRate_hz;
        lesson.send_pose(now_s);
        const std::optional<motion::TimedPose> pose = lesson.source->newest(now_s);
        lesson.coach.update(pose, now_s, lesson.clip_time(lesson.shown(now_s)));
        if (i + 1 == (packets + 9) / 10) heap.early = allocated_bytes();
        progress.update(i + 1);
    }
    heap.late = allocated_bytes();
    const uint64_t poses = lesson.source->state().poses;
    if (!stop_requested() && poses != packets)
        throw RuntimeFailure(fmt::format("{} poses came of {} packets", poses, packets));
    return heap;
}

void print_steps(const Steps& steps, const gpu::Device& device, const CoachOptions& options) {
    fmt::print("{}, {} on {}: a limb is red in {} of {} frames\n", options.scene, options.size, device.summary().name,
               steps.red_frames, steps.red.size());
    const auto line = [](const char* name, const std::vector<double>& ms) {
        fmt::print("{:<46} {:>8.3f} ms median {:>8.3f} ms p99\n", name, median(ms), quantile(ms, 0.99));
    };
    line("read a packet and make a pose of it", steps.packet);
    line("update the coach", steps.update);
    line("  of which filter and compare", steps.compare);
    line("  of which choose the view", steps.view);
    line("colours of bones, ghost and arrows", steps.show);
    line("a frame without highlight", steps.plain);
    line("a frame with it", steps.red);
    line("  more than without, frame by frame", steps.added);
    line("  of which bind bones", steps.bind);
    line("  of which tint", steps.tint);
    line("all that is added beside the render", steps.all);
    fmt::print("at most {:.0f} ms is wanted\n", kBar_ms);
}

nlohmann::ordered_json json_of_steps(const Steps& steps) {
    return {{"frames", steps.red.size()},
            {"red_frames", steps.red_frames},
            {"packet_ms", median(steps.packet)},
            {"update_ms", median(steps.update)},
            {"compare_ms", median(steps.compare)},
            {"view_ms", median(steps.view)},
            {"show_ms", median(steps.show)},
            {"plain_ms", median(steps.plain)},
            {"red_ms", median(steps.red)},
            {"highlight_ms", median(steps.added)},
            {"bind_ms", median(steps.bind)},
            {"tint_ms", median(steps.tint)},
            {"added_p99_ms", quantile(steps.all, 0.99)},
            {"added_ms", median(steps.all)}};
}

void run_coach(const CoachOptions& options, const tools::CommonOptions& common) {
    catch_stop_signals();
    Lesson lesson(options);
    const gpu::Device device(common.device);
    const Steps steps = measure_steps(device, lesson, options);
    expect_not_stopped();
    nlohmann::ordered_json json = json_of_steps(steps);
    HeapGrowth heap;
    if (options.packets > 0) {
        Lesson hour(options);
        heap = measure_heap(hour, options.packets);
        expect_not_stopped();
        json["packets"] = options.packets;
        json["heap_early_bytes"] = heap.early;
        json["heap_late_bytes"] = heap.late;
    }
    report(options, device, json, [&] {
        print_steps(steps, device, options);
        if (options.packets > 0)
            fmt::print("{} packets, {:.0f} s at {:.0f} Hz: the heap grew from {:.1f} KiB after a tenth by {:.1f} KiB\n",
                       options.packets, options.packets / kPacketRate_hz, kPacketRate_hz,
                       static_cast<double>(heap.early) / 1024,
                       (static_cast<double>(heap.late) - static_cast<double>(heap.early)) / 1024);
    });
}

}  // namespace

void add_coach(tools::Command app, const tools::CommonOptions& common) {
    auto [verb, options] = add_verb(
        app, common,
        {"coach",
         "What a trainee adds to a frame",
         "Sends a body by the VMC protocol to a port of its own, a packet for each frame of the clip, and prints how "
         "long each step\nfrom the packet to the red limb takes. Each frame is drawn with and without the highlight, "
         "in "
         "either order. The time that a\npacket waits for the next frame is not in it.\n",
         {"work/performer.nvv --against tools/performer/trainee.glb", "work/performer.nvv --packets 216000"},
         "A stage or a .nvv whose performer has a skeleton"},
        run_coach);
    verb.add_option("--against", options.against,
                    "The trainee's motion, as of `neuvv coach` (default: the trainer's, left and right exchanged)");
    verb.add_option("--performer", options.performer, "The trainer's name (default: the first with a skeleton)");
    add_size_option(verb, options);
    verb.add_option("--frames", options.frames, "Frames that the medians are over").in_range(1, 100000).show_default();
    verb.add_option(
            "--packets", options.packets,
            "Then also: how much the heap grows over so many packets, 60 a second of a virtual clock; 216000 are an "
            "hour")
        .in_range(10, 10000000);
    tools::add_slice_budget_option(verb, options.slice_budget_mb);
    add_json_flag(verb, options);
}

}  // namespace neuvv::bench

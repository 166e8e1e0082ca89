#include "tools/headset/headset.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/platform.h"
#include "editor/open_file.h"
#include "tools/headset/hand_shapes.h"
#include "tools/headset/mirror.h"
#include "tools/headset/panel.h"
#include "tools/headset/panel_surface.h"
#include "tools/headset/settings.h"
#include "tools/headset/sound.h"
#include "tools/headset/training.h"
#include "tools/headset/wearer.h"
#include "tools/options.h"
#include "xr/actions.h"

namespace neuvv::headset {

namespace {

using Clock = std::chrono::steady_clock;
constexpr double kNotice_s = 6, kMaxStep_s = 0.25, kFinish_s = 60;
constexpr double kDrawShare = 0.85;       // the share of the display's period that drawing may take
constexpr int32_t kPrefetchedFrames = 2;  // frames whose slices are built before they are shown

double seconds_since(Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
}

void print_line(const std::string& line) {
    fmt::print(stderr, "{}\n", line);
}

// All that outlives sessions and runtimes.
struct Program {
    explicit Program(const HeadsetOptions& given)
        : options(given), jobs([this](const std::string& problem) { state.editor.notify(problem, true); }, [] {}) {}

    const HeadsetOptions& options;
    HeadsetState state;
    JobQueue jobs;
    editor::SoundPlayer sound;
    Interaction interaction = Interaction(jobs);
    Training training = Training(jobs);
    HeadsetSettings settings = HeadsetSettings(config_folder().empty() ? "" : config_folder() / "headset.json");
    std::optional<editor::DocumentSaver> saver;
    std::vector<editor::Notice> notices;
    std::unique_ptr<ui::Window> window;  // of the mirror; null without --mirror
    Clock::time_point began = Clock::now();
    bool rig_is_set = false;       // the user has a position in the stage
    bool leaving = false;          // the user wants to leave
    std::optional<xr::Pose> head;  // tracking space; the last tracked pose
    uint64_t frames = 0;           // drawn since the program began
    std::map<std::string, glm::dvec2> panel_items;

    double confirm_until_s = 0;  // until then, Leave leaves although there are unsaved edits

    double now_s() const { return seconds_since(began); }
    void leave();
    void open();
    void notify();
    void finish();
};

void Program::open() {
    const std::filesystem::path stage = editor::stage_of_file(options.file);
    std::vector<edit::RecoveryEntry> recoverable = editor::lost_edits_of(stage);
    std::optional<edit::RecoveryEntry> recovered;
    if (!recoverable.empty()) recovered = std::move(recoverable.front());
    if (recovered && !options.recover) {
        print_line(fmt::format("unsaved edits of {} are kept: --recover takes them", stage.string()));
        recovered.reset();
    }
    if (recovered) state.editor.notify("unsaved edits of an earlier run are taken: save keeps them");
    if (recovered && edit::has_foreign_file(*recovered))
        state.editor.notify("the stage's file has changed since: saving keeps that beside it");
    state.editor.open(recovered ? edit::restore(*recovered) : editor::open_document(options.file),
                      recovered.has_value());
    state.follow_document();
    settings.load(state, interaction.grab.settings);
    state.clock.playing = options.play;
    if (!options.trainee.empty())
        training.begin(state, coach::read_trainer(*state.stage, ""), motion::open_pose_source(options.trainee));
    state.evaluate();
    saver.emplace(state.editor, jobs);
    saver->autosave.opened(std::move(recovered));
}

// Ends grabs and strokes, and waits up to kFinish_s for unfinished strokes and files.
void Program::finish() {
    interaction.grab.release(state);
    interaction.painter.end_stroke(state);
    const Clock::time_point from = Clock::now();
    do {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        jobs.run_posted();
        state.follow_document();
        interaction.painter.process_strokes(state);
    } while ((!jobs.idle() || jobs.has_posted() || interaction.painter.is_at_work()) &&
             seconds_since(from) < kFinish_s);
    notify();
}

// The recovery files keep unsaved edits. Still, the first press of Leave only reports that there are any.
void Program::leave() {
    leaving = !state.editor.modified() || saver->saving() || now_s() < confirm_until_s;
    if (leaving) return;
    confirm_until_s = now_s() + kNotice_s;
    state.editor.notify("not saved: Leave once more keeps the edits for --recover", true);
}

// Prints new notices, and removes those that have been on the panel for kNotice_s.
void Program::notify() {
    for (editor::Notice& notice : state.editor.take_notices()) {
        print_line(notice.text);
        notice.until_s = now_s() + kNotice_s;
        notices.push_back(std::move(notice));
    }
    std::erase_if(notices, [&](const editor::Notice& notice) { return notice.until_s < now_s(); });
}

// The runtime, the device that it created, and the stage on that device.
struct RuntimeContext {
    explicit RuntimeContext(Program& program);
    void follow(Program& program);

    xr::Runtime runtime;
    gpu::Device device;
    // All clips that were ever on the stage, so that undoing a deletion reads no file between two frames. Of segmented
    // clips, it is the first segment.
    std::map<std::filesystem::path, std::shared_ptr<const render::Field>> clips;
    std::unique_ptr<render::StageLoader> loader;
    std::unique_ptr<render::StageRenderer> renderer;  // created with the first session, for the size of its images
    std::shared_ptr<const stage::Stage> drawn_stage;
};

RuntimeContext::RuntimeContext(Program& program)
    : device(
          program.options.device, program.options.validate ? gpu::Validation::kOn : gpu::Validation::kOff,
          [this, &program] {
              gpu::DeviceExtensions extensions = runtime.device_extensions();
              if (!program.window) return extensions;
              const gpu::DeviceExtensions more = program.window->extensions();
              extensions.instance.insert(extensions.instance.end(), more.instance.begin(), more.instance.end());
              extensions.device.insert(extensions.device.end(), more.device.begin(), more.device.end());
              return extensions;
          }(),
          runtime.device_maker()) {}

void update_clips(HeadsetState& state, RuntimeContext& context) {
    state.leaf_boxes.clear();
    for (uint32_t clip = 0; clip < state.stage->clips.size(); clip++) {
        state.leaf_boxes.push_back(context.renderer->leaf_box(clip));
        context.clips[state.stage->clips[clip].path] = context.renderer->shared_field(clip);
    }
}

void RuntimeContext::follow(Program& program) {
    program.state.follow_document();
    if (drawn_stage == program.state.stage) return;
    try {
        renderer->change(*program.state.stage, loader->load(*program.state.stage));
    } catch (const InputError& error) {  // a clip or a layer is missing: the last edit cannot be shown
        program.state.stage = drawn_stage;
        return program.state.editor.take_back(error.what());
    }
    drawn_stage = program.state.stage;
    update_clips(program.state, *this);
}

void print_validation_messages(const gpu::Device& device) {
    for (const std::string& message : device.drain_validation_messages()) print_line("validation: " + message);
}

// A session, with its input and its images.
struct SessionContext {
    SessionContext(Program& program, RuntimeContext& context)
        : xr_session(context.runtime, context.device),
          actions(xr_session),
          hand_tracking(xr_session),
          eyes(context.device, xr_session, program.options.quality),
          panel(context.device, xr_session) {}
    xr::Session xr_session;
    xr::Actions actions;
    xr::HandTracking hand_tracking;
    std::optional<WearerBody> body;  // once it is needed
    EyeImages eyes;
    PanelSurface panel;
    std::unique_ptr<Mirror> mirror;
    xr::EyeShapes shapes;
    XrTime last_display = 0;
    double images_per_second = 0;
};

void make_renderer(Program& program, RuntimeContext& context, const EyeImages& eyes) {
    if (context.renderer) return;
    const render::PaintSource paint = [&program](const std::filesystem::path& layer) {
        return voctree::files_of_layer(program.state.editor.document().paint, stage::absolute_path(layer));
    };
    context.drawn_stage = program.state.stage;
    context.loader = std::make_unique<render::StageLoader>(context.device, paint);
    context.renderer = std::make_unique<render::StageRenderer>(
        context.device, *context.drawn_stage, context.loader->load(*context.drawn_stage), eyes.capacity());
    update_clips(program.state, context);
    program.state.evaluate();
    if (!program.rig_is_set)
        program.state.floor_m = editor::floor_of(program.state);  // afterwards it stays, as the user stands on it
}

void handle_events(const xr::SessionEvents& events, SessionContext& session) {
    if (events.controllers_changed) {
        session.actions.update_controllers();
        for (const int hand : {xr::kLeft, xr::kRight})
            if (const std::string controller = session.actions.controller(hand); !controller.empty())
                print_line(fmt::format("{} hand: {}", hand == xr::kLeft ? "left" : "right", controller));
    }
    for (uint32_t eye = 0; eye < xr::kEyes; eye++)
        if (events.mask_changed[eye]) session.eyes.invalidate_mask(eye);
}

// The times of the next kPrefetchedFrames frames of the stage, while it plays.
std::vector<double> next_times(const editor::StageClock& clock) {
    std::vector<double> times;
    for (int32_t n = 1; clock.playing && n <= kPrefetchedFrames; n++) times.push_back(clock.displayed_after_s(n));
    return times;
}

// The wearer's body, where somebody trains with it.
std::optional<motion::Pose> locate_body(Program& program, SessionContext& session, const xr::HandInputs& inputs,
                                        const std::optional<xr::Pose>& head, const xr::FrameTime& time) {
    if (!program.training.needs_body()) return std::nullopt;
    if (!session.body) {
        session.body.emplace(session.xr_session, session.actions, session.hand_tracking);
        program.state.editor.notify(fmt::format("your body: {}", xr::title_of(session.body->source())));
    }
    return session.body->locate(inputs, head, program.state.rig, time.display);
}

// Updates hands, edits and the stage's time to the time at which the display shows this frame.
void update_stage(Program& program, RuntimeContext& context, SessionContext& session, const xr::FrameTime& time,
                  double dt_s) {
    HeadsetState& state = program.state;
    xr::HandInputs inputs = session.actions.sample(time.display);
    session.hand_tracking.locate(time.display);
    for (const int hand : {xr::kLeft, xr::kRight})
        xr::fill_from_joints(inputs[hand], session.hand_tracking.joints(hand));
    const auto head = session.xr_session.locate(session.xr_session.head_space(), time.display);
    if (head) program.head = *head;
    if (head && !program.rig_is_set) {
        state.rig = initial_rig(state, *head);
        program.rig_is_set = true;
    }
    program.jobs.run_posted();
    context.follow(program);  // edits that are made after this show in the next frame
    state.clock.tick(dt_s);
    state.evaluate();
    program.training.turn_trainer(state, dt_s);
    if (program.head) {
        program.interaction.update(state, inputs, *program.head, dt_s);
        program.training.update(state, locate_body(program, session, inputs, head, time),
                                xr::world_from_tracking(state.rig) * program.head->position);
    }
    for (const int hand : {xr::kLeft, xr::kRight})
        if (const double pulse = program.interaction.hands[hand].vibration; pulse > 0)
            session.actions.vibrate(hand, pulse, 0.03);
    if (program.head) play_sound(state, program.sound, *program.head);
    program.saver->autosave.tick(program.now_s());
    program.notify();
}

void update_panel(Program& program, SessionContext& session, double dt_s) {
    if (!program.interaction.panel) return;
    PanelResult result;
    const PanelStatus status{program.notices, session.images_per_second, session.eyes.scale(), program.saver->saving()};
    if (program.state.is_behind() && session.panel.has_image())
        return;  // hands have edited the document: its nodes do not match the stage
    const PanelPointer pointer = program.interaction.panel_pointer();
    session.panel.draw(pointer, dt_s,
                       [&] { result = draw_panel(program.state, program.interaction, program.training, status); });
    program.panel_items = result.items;
    if (result.save && !program.saver->saving()) program.saver->save(program.saver->default_path());
    if (result.leave) program.leave();
}

// Draws the stage for both eyes. Returns false while the poses of the eyes are not known.
bool draw_eyes(Program& program, RuntimeContext& context, SessionContext& session, const xr::FrameTime& time) {
    HeadsetState& state = program.state;
    const bool hides_room = context.runtime.blend_mode() == XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    context.renderer->show(state.evaluated, hides_room, render::MissingSegments::kHold);
    for (const std::string& problem : context.renderer->take_problems()) print_line("not shown: " + problem);
    const xr::Pose world = xr::world_from_tracking(state.rig);
    const auto head = session.xr_session.locate(session.xr_session.head_space(), time.display);
    session.shapes.begin(world * (head ? head->position : glm::dvec3(0)), session.eyes.pixel_rad());
    if (hides_room) draw_floor(session.shapes, state);
    draw_guide(session.shapes, program.training.session().guide());
    draw_interaction(session.shapes, state, program.interaction);
    for (const int hand : {xr::kLeft, xr::kRight})
        if (program.interaction.hands[hand].input.bare_hand)
            draw_joints(session.shapes, session.hand_tracking.joints(hand), world);
    const std::vector<render::Instance> next = context.renderer->instances_at(next_times(state.clock));
    // As late as possible, for the newest prediction: all that does not depend on the head has been done before.
    const auto eyes = session.xr_session.locate_eyes(time.display);
    if (!eyes) return false;
    session.eyes.draw(*context.renderer, state.evaluated, program.training.session().highlight(), *eyes, world, next,
                      session.shapes, program.interaction.locomotion.vignette(),
                      kDrawShare * static_cast<double>(time.period) / 1e6);
    return true;
}

void frame(Program& program, RuntimeContext& context, SessionContext& session) {
    const xr::FrameTime time = session.xr_session.wait_frame();
    const double dt_s =
        session.last_display > 0
            ? std::clamp(static_cast<double>(time.display - session.last_display) / 1e9, 0.0, kMaxStep_s)
            : 0;
    session.last_display = time.display;
    if (dt_s > 0) session.images_per_second += 0.1 * (1 / dt_s - session.images_per_second);
    session.xr_session.begin_frame();
    update_stage(program, context, session, time, dt_s);
    std::vector<const XrCompositionLayerBaseHeader*> layers;
    if (time.should_render) {
        update_panel(program, session, dt_s);
        if (draw_eyes(program, context, session, time)) {
            const auto& panel = program.interaction.panel;
            if (panel)
                layers.push_back(session.panel.layer(
                    session.xr_session,
                    xr::inverse(xr::world_from_tracking(program.state.rig)) * panel->world_from_panel, panel->size_m));
            layers.push_back(session.eyes.layer(session.xr_session, panel.has_value()));
        }
    }
    session.xr_session.end_frame(time, layers);
    program.frames += !layers.empty();
    if (session.mirror && !session.mirror->show(session.eyes.left())) program.leaving = true;
}

void request_refresh_rate(const Program& program, SessionContext& session) {
    if (!program.options.refresh_hz) return;
    const std::vector<float> rates = session.xr_session.refresh_rates();
    if (rates.empty()) return print_line("the runtime's refresh rate cannot be chosen");
    const auto requested = static_cast<float>(*program.options.refresh_hz);
    const float nearest = *std::min_element(rates.begin(), rates.end(), [&](float a, float b) {
        return std::abs(a - requested) < std::abs(b - requested);
    });
    session.xr_session.request_refresh_rate(nearest);
}

// Returns when the session has ended (kEnded), or is lost so that another one may be begun (kLost).
xr::SessionStatus run_session(Program& program, RuntimeContext& context) {
    SessionContext session(program, context);
    make_renderer(program, context, session.eyes);
    session.actions.update_controllers();
    if (program.window) session.mirror = std::make_unique<Mirror>(context.device, *program.window, session.eyes.size());
    bool exit_requested = false, rate_requested = false;
    for (;;) {
        xr::SessionEvents events;
        const xr::SessionStatus status = session.xr_session.poll(events);
        handle_events(events, session);
        if (status == xr::SessionStatus::kEnded || status == xr::SessionStatus::kLost) {
            program.interaction.grab.release(program.state);
            stop_sound(program.state, program.sound);
            return status;
        }
        if ((program.leaving || stop_requested()) && !std::exchange(exit_requested, true))
            session.xr_session.request_exit();
        if (status == xr::SessionStatus::kIdle) {
            stop_sound(program.state, program.sound);
            program.jobs.run_posted();
            program.saver->autosave.tick(program.now_s());
            program.notify();
            if (session.mirror && !session.mirror->show(session.eyes.left())) program.leaving = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            continue;
        }
        if (!std::exchange(rate_requested, true)) request_refresh_rate(program, session);
        frame(program, context, session);
    }
}

// A timeout for retries, which begins anew whenever frames have been drawn.
class RetryLimit {
  public:
    explicit RetryLimit(const Program& program) : program_(program), frames_(program.frames) {}
    // To be called after a failure: pauses before the next try. Throws RuntimeFailure after the timeout.
    void wait(const std::string& why) {
        if (program_.frames != frames_) from_ = Clock::now();
        has_run_ |= program_.frames != frames_;
        frames_ = program_.frames;
        if (seconds_since(from_) > program_.options.retry_s)
            throw RuntimeFailure(fmt::format("the headset's runtime does not come back: {}", why));
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
    bool has_run() const { return has_run_ || program_.frames != frames_; }

  private:
    const Program& program_;
    uint64_t frames_;
    bool has_run_ = false;
    Clock::time_point from_ = Clock::now();
};

// Runs sessions on one runtime until the user leaves. Throws XrFailure where the runtime is lost.
void run_sessions(Program& program, RuntimeContext& context) {
    print_line(fmt::format("{}, \"{}\", on {}", context.runtime.name(), context.runtime.headset(),
                           context.device.summary().name));
    for (RetryLimit retries(program);;) {
        std::string why = "every session ends";
        try {
            if (run_session(program, context) == xr::SessionStatus::kEnded)
                return print_validation_messages(context.device);
        } catch (const xr::XrFailure& failure) {
            program.interaction.grab.release(program.state);
            if (!failure.session_lost() || !retries.has_run()) throw;
            why = failure.what();
        }
        print_validation_messages(context.device);
        if (stop_requested() || program.leaving) return;
        program.state.editor.notify("the headset's session was lost; another one begins");
        program.notify();
        retries.wait(why);
    }
}

void run_runtimes(Program& program) {
    for (RetryLimit retries(program);;) {
        std::string why;
        try {
            RuntimeContext context(program);
            run_sessions(program, context);
            return;
        } catch (const xr::XrFailure& failure) {
            program.interaction.grab.release(program.state);
            if (!failure.instance_lost() || !retries.has_run()) throw;
            why = failure.what();
            print_line("the headset's runtime was lost; waiting for it");
        } catch (const RuntimeFailure& failure) {
            if (!retries.has_run()) throw;
            why = failure.what();
        }
        if (stop_requested() || program.leaving) return;
        retries.wait(why);
    }
}

void write_report(const Program& program) {
    nlohmann::json report;
    const xr::Pose tracking = xr::inverse(xr::world_from_tracking(program.state.rig));
    for (const auto& [name, at] : program.panel_items) {
        if (!program.interaction.panel) break;
        const glm::dvec3 place = tracking * program.interaction.panel->point_at(at);
        report["panel"][name] = {place.x, place.y, place.z};
    }
    report["time_s"] = program.state.clock.time_s();
    report["speed"] = program.state.clock.speed;
    report["playing"] = program.state.clock.playing;
    report["stands"] = {program.state.rig.position.x, program.state.rig.position.y, program.state.rig.position.z};
    report["turned_deg"] = glm::degrees(program.state.rig.yaw_rad);
    report["train"] = program.training.facts();
    report["modified"] = program.state.editor.modified();
    const std::string text = report.dump(1);
    write_file_atomically(program.options.report, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

}  // namespace

void run_headset(const HeadsetOptions& options) {
    catch_stop_signals();
    Program program(options);
    program.open();
    if (options.mirror) program.window = std::make_unique<ui::Window>("NeuVV in a headset", ui::WindowGeometry{});
    const auto save_all = [&] {
        program.finish();
        program.jobs.stop();
        try {
            program.settings.save(program.state, program.interaction.grab.settings);
        } catch (const RuntimeFailure& failure) {
            print_line(failure.what());
        }
        if (program.saver->autosave.store_now())
            print_line(
                fmt::format("unsaved edits are kept: `neuvv xr '{0}' --recover` or `neuvv view '{0}'` takes them",
                            options.file.string()));
    };
    try {
        run_runtimes(program);
    } catch (...) {
        save_all();
        throw;
    }
    save_all();
    if (!options.report.empty()) write_report(program);
}

}  // namespace neuvv::headset

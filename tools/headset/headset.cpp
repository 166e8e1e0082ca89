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
#include "tools/options.h"
#include "xr/actions.h"

namespace neuvv::headset {

namespace {

using Clock = std::chrono::steady_clock;
constexpr double kNotice_s = 6, kMostStep_s = 0.25, kFinish_s = 60;
constexpr double kShare = 0.85;  // of a period of the display that drawing may take
constexpr int32_t kAhead = 2;    // images of the clip whose slices are made ahead

double seconds_since(Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
}

void say(const std::string& line) {
    fmt::print(stderr, "{}\n", line);
}

// What outlives sessions and runtimes.
struct Program {
    explicit Program(const HeadsetOptions& wanted)
        : options(wanted), jobs([this](const std::string& problem) { on.editor.notify(problem, true); }, [] {}) {}

    const HeadsetOptions& options;
    OnStage on;
    JobQueue jobs;
    Interaction interaction = Interaction(jobs);
    HeadsetSettings settings = HeadsetSettings(config_folder().empty() ? "" : config_folder() / "headset.json");
    std::optional<editor::DocumentSaver> saver;
    std::vector<editor::Notice> notices;
    std::unique_ptr<ui::Window> window;  // of the mirror
    Clock::time_point began = Clock::now();
    bool placed = false;           // the user stands somewhere
    bool leaves = false;           // was asked to
    std::optional<xr::Pose> head;  // tracking space: where it was last
    uint64_t frames = 0;           // drawn, of the runtime that is there
    std::map<std::string, glm::dvec2> panel_items;

    double asked_until_s = 0;  // whether to leave what is not saved

    double now_s() const { return seconds_since(began); }
    void leave();
    void open();
    void notify();
    void finish();
};

void Program::open() {
    const std::filesystem::path stage = editor::stage_of_file(options.file);
    std::vector<edit::RecoveryEntry> all_lost = editor::lost_edits_of(stage);
    std::optional<edit::RecoveryEntry> lost;
    if (!all_lost.empty()) lost = std::move(all_lost.front());
    if (lost && !options.recover) {
        say(fmt::format("unsaved edits of {} are kept: --recover takes them", stage.string()));
        lost.reset();
    }
    if (lost) on.editor.notify("unsaved edits of an earlier run are taken: save keeps them");
    if (lost && edit::has_foreign_file(*lost))
        on.editor.notify("the stage's file has changed since: saving keeps that beside it");
    on.editor.open(lost ? edit::restore(*lost) : editor::open_document(options.file), lost.has_value());
    on.follow_document();
    settings.load(on, interaction.holding.settings);
    on.clock.playing = options.play;
    on.evaluate();
    saver.emplace(on.editor, jobs);
    saver->autosave.opened(std::move(lost));
}

// What is held is put down, and what is being painted or saved comes to its end.
void Program::finish() {
    interaction.holding.put_down(on);
    interaction.brush.end_stroke(on);
    const Clock::time_point from = Clock::now();
    do {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        jobs.run_posted();
        on.follow_document();
        interaction.brush.lay(on);
    } while ((!jobs.idle() || jobs.has_posted() || interaction.brush.busy()) && seconds_since(from) < kFinish_s);
    notify();
}

// Unsaved edits are not lost, but whoever leaves should know of them.
void Program::leave() {
    leaves = !on.editor.modified() || saver->saving() || now_s() < asked_until_s;
    if (leaves) return;
    asked_until_s = now_s() + kNotice_s;
    on.editor.notify("not saved: Leave once more keeps the edits for --recover", true);
}

// Notices are shown for a while, and said on the terminal.
void Program::notify() {
    for (editor::Notice& notice : on.editor.take_notices()) {
        say(notice.text);
        notice.until_s = now_s() + kNotice_s;
        notices.push_back(std::move(notice));
    }
    std::erase_if(notices, [&](const editor::Notice& notice) { return notice.until_s < now_s(); });
}

// A stage on a device, for as long as the runtime lives that made it.
struct OnRuntime {
    explicit OnRuntime(Program& of);
    void follow(Program& program);

    xr::Runtime runtime;
    gpu::Device device;
    // Of all clips that were ever on stage, as read last: undoing a deletion in a session must not read one.
    std::map<std::filesystem::path, std::shared_ptr<const render::Field>> fields;
    std::unique_ptr<render::StageLoader> loader;
    std::unique_ptr<render::StageRenderer> renderer;  // made for the first session's images
    std::shared_ptr<const stage::Stage> drawn;
};

OnRuntime::OnRuntime(Program& of)
    : device(
          of.options.device, of.options.validate ? gpu::Validation::kOn : gpu::Validation::kOff,
          [this, &of] {
              gpu::DeviceExtensions extensions = runtime.device_extensions();
              if (!of.window) return extensions;
              const gpu::DeviceExtensions more = of.window->extensions();
              extensions.instance.insert(extensions.instance.end(), more.instance.begin(), more.instance.end());
              extensions.device.insert(extensions.device.end(), more.device.begin(), more.device.end());
              return extensions;
          }(),
          runtime.device_maker()) {}

void know_clips(OnStage& on, OnRuntime& at) {
    on.leaf_boxes.clear();
    for (uint32_t clip = 0; clip < on.stage->clips.size(); clip++) {
        const auto field = at.renderer->shared_field(clip);
        on.leaf_boxes.emplace_back(field->leaves_min, field->leaves_max);
        at.fields[on.stage->clips[clip].path] = field;
    }
}

void OnRuntime::follow(Program& program) {
    program.on.follow_document();
    if (drawn == program.on.stage) return;
    try {
        renderer->change(*program.on.stage, loader->load(*program.on.stage));
    } catch (const InputError& error) {  // a clip or a layer that is not there: the last edit cannot be shown
        program.on.stage = drawn;
        return program.on.editor.take_back(error.what());
    }
    drawn = program.on.stage;
    know_clips(program.on, *this);
}

void tell_validation(const gpu::Device& device) {
    for (const std::string& message : device.drain_validation_messages()) say("validation: " + message);
}

// A session's images and hands.
struct InSession {
    InSession(Program& program, OnRuntime& at)
        : session(at.runtime, at.device),
          actions(session),
          fingers(session),
          eyes(at.device, session, program.options.quality),
          panel(at.device, session) {}
    xr::Session session;
    xr::Actions actions;
    xr::HandTracking fingers;
    EyeImages eyes;
    PanelSurface panel;
    std::unique_ptr<Mirror> mirror;
    xr::EyeShapes shapes;
    XrTime last_display = 0;
    double images_per_second = 0;
};

void make_renderer(Program& program, OnRuntime& at, const EyeImages& eyes) {
    if (at.renderer) return;
    const render::PaintSource paint = [&program](const std::filesystem::path& path, const voctree::PaintedField&) {
        const auto& edited = program.on.editor.document().paint;
        const auto found = edited.find(stage::absolute_path(path));
        return found != edited.end() ? found->second : nullptr;
    };
    at.drawn = program.on.stage;
    at.loader = std::make_unique<render::StageLoader>(at.device, paint);
    at.renderer =
        std::make_unique<render::StageRenderer>(at.device, *at.drawn, at.loader->load(*at.drawn), eyes.capacity());
    know_clips(program.on, at);
    program.on.evaluate();
    if (!program.placed) program.on.floor_m = editor::floor_of(program.on);  // later it stays, with who stands on it
}

void hear(const xr::SessionNews& news, InSession& in) {
    if (news.controllers) {
        in.actions.look_at_controllers();
        for (const int hand : {xr::kLeft, xr::kRight})
            if (const std::string controller = in.actions.controller(hand); !controller.empty())
                say(fmt::format("{} hand: {}", hand == xr::kLeft ? "left" : "right", controller));
    }
    for (uint32_t eye = 0; eye < xr::kEyes; eye++)
        if (news.mask[eye]) in.eyes.look_at_mask(eye);
}

// Slices of what will be seen next.
std::vector<render::NextSlice> slices_ahead(const Program& program, const render::StageRenderer& renderer) {
    std::vector<render::NextSlice> next;
    if (!program.on.clock.playing) return next;
    for (int32_t n = 1; n <= kAhead; n++)
        for (const render::Instance& instance :
             renderer.settings_at(stage::stage_at(*program.on.stage, program.on.clock.displayed_after_s(n))).instances)
            next.push_back({{instance.frame, instance.paint}, instance.field});
    return next;
}

// Hands, time and edits up to the time at which this frame is seen.
void update_stage(Program& program, OnRuntime& at, InSession& in, const xr::FrameTime& time, double dt_s) {
    OnStage& on = program.on;
    xr::HandInputs inputs = in.actions.sample(time.display);
    in.fingers.locate(time.display);
    for (const int hand : {xr::kLeft, xr::kRight}) xr::stand_in(inputs[hand], in.fingers.joints(hand));
    const auto head = in.session.locate(in.session.head_space(), time.display);
    if (head) program.head = *head;
    if (head && !program.placed) {
        on.rig = first_rig(on, *head);
        program.placed = true;
    }
    program.jobs.run_posted();
    at.follow(program);  // what is edited from here on is seen in the next frame
    on.clock.tick(dt_s);
    on.evaluate();
    if (program.head) program.interaction.update(on, inputs, *program.head, dt_s);
    for (const int hand : {xr::kLeft, xr::kRight})
        if (const double pulse = program.interaction.hands[hand].pulse; pulse > 0) in.actions.pulse(hand, pulse, 0.03);
    program.saver->autosave.tick(program.now_s());
    program.notify();
}

void draw_panel_of(Program& program, InSession& in, double dt_s) {
    if (!program.interaction.panel) return;
    PanelAsks asks;
    const PanelFacts facts{program.notices, in.images_per_second, in.eyes.scale(), program.saver->saving()};
    if (program.on.is_behind() && in.panel.has_image()) return;  // hands have edited what it shows: as it was
    const PanelPointer pointer = program.interaction.panel_pointer();
    in.panel.draw(pointer, dt_s, [&] { asks = draw_panel(program.on, program.interaction, facts); });
    program.panel_items = asks.items;
    if (asks.save && !program.saver->saving()) program.saver->save(program.saver->default_path());
    if (asks.leave) program.leave();
}

// The stage as it is now for both eyes. False: there is nothing to be shown yet.
bool draw_eyes(Program& program, OnRuntime& at, InSession& in, const xr::FrameTime& time) {
    OnStage& on = program.on;
    const bool hides_room = at.runtime.blend_mode() == XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    at.renderer->show(on.evaluated, hides_room);
    const xr::Pose world = xr::world_from_tracking(on.rig);
    const auto head = in.session.locate(in.session.head_space(), time.display);
    in.shapes.begin(world * (head ? head->position : glm::dvec3(0)), in.eyes.pixel_rad());
    if (hides_room) draw_floor(in.shapes, on);
    draw_interaction(in.shapes, on, program.interaction);
    for (const int hand : {xr::kLeft, xr::kRight})
        if (program.interaction.hands[hand].input.bare) draw_joints(in.shapes, in.fingers.joints(hand), world);
    const std::vector<render::NextSlice> next = slices_ahead(program, *at.renderer);
    // As late as may be: all that does not depend on where the head is has been done.
    const auto eyes = in.session.locate_eyes(time.display);
    if (!eyes) return false;
    in.eyes.draw(*at.renderer, on.evaluated, *eyes, world, next, in.shapes, program.interaction.walking.vignette(),
                 kShare * static_cast<double>(time.period) / 1e6);
    return true;
}

void frame(Program& program, OnRuntime& at, InSession& in) {
    const xr::FrameTime time = in.session.wait();
    const double dt_s = in.last_display > 0
                            ? std::clamp(static_cast<double>(time.display - in.last_display) / 1e9, 0.0, kMostStep_s)
                            : 0;
    in.last_display = time.display;
    if (dt_s > 0) in.images_per_second += 0.1 * (1 / dt_s - in.images_per_second);
    in.session.begin();
    update_stage(program, at, in, time, dt_s);
    std::vector<const XrCompositionLayerBaseHeader*> layers;
    if (time.render) {
        draw_panel_of(program, in, dt_s);
        if (draw_eyes(program, at, in, time)) {
            const auto& panel = program.interaction.panel;
            if (panel)
                layers.push_back(in.panel.layer(
                    in.session, xr::inverse(xr::world_from_tracking(program.on.rig)) * panel->world, panel->size_m));
            layers.push_back(in.eyes.layer(in.session, panel.has_value()));
        }
    }
    in.session.end(time, layers);
    program.frames += !layers.empty();
    if (in.mirror && !in.mirror->show(in.eyes.left())) program.leaves = true;
}

void ask_for_rate(const Program& program, InSession& in) {
    if (!program.options.refresh_hz) return;
    const std::vector<float> rates = in.session.refresh_rates();
    if (rates.empty()) return say("the runtime's refresh rate cannot be chosen");
    const auto wanted = static_cast<float>(*program.options.refresh_hz);
    const float nearest = *std::min_element(
        rates.begin(), rates.end(), [&](float a, float b) { return std::abs(a - wanted) < std::abs(b - wanted); });
    in.session.request_refresh_rate(nearest);
}

// Until it ends. kLost: another session may be begun.
xr::SessionDoes run_session(Program& program, OnRuntime& at) {
    InSession in(program, at);
    make_renderer(program, at, in.eyes);
    in.actions.look_at_controllers();
    if (program.window) in.mirror = std::make_unique<Mirror>(at.device, *program.window, in.eyes.size());
    bool asked = false, rated = false;
    for (;;) {
        xr::SessionNews news;
        const xr::SessionDoes does = in.session.poll(news);
        hear(news, in);
        if (does == xr::SessionDoes::kEnd || does == xr::SessionDoes::kLost) {
            program.interaction.holding.put_down(program.on);
            return does;
        }
        if ((program.leaves || stop_requested()) && !std::exchange(asked, true)) in.session.request_exit();
        if (does == xr::SessionDoes::kWait) {
            program.jobs.run_posted();
            program.saver->autosave.tick(program.now_s());
            program.notify();
            if (in.mirror && !in.mirror->show(in.eyes.left())) program.leaves = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            continue;
        }
        if (!std::exchange(rated, true)) ask_for_rate(program, in);
        frame(program, at, in);
    }
}

// Another session may do where this one was lost, or the headset was unplugged.
bool is_session_loss(const xr::XrFailure& failure) {
    return failure.result == XR_ERROR_SESSION_LOST || failure.result == XR_ERROR_FORM_FACTOR_UNAVAILABLE;
}

bool is_instance_loss(const xr::XrFailure& failure) {
    return failure.result == XR_ERROR_INSTANCE_LOST || failure.result == XR_ERROR_RUNTIME_FAILURE ||
           failure.result == XR_ERROR_RUNTIME_UNAVAILABLE;
}

// How long one tries for what is not there: from the last frame on, or from the start.
class RetryLimit {
  public:
    explicit RetryLimit(const Program& program) : program_(program), frames_(program.frames) {}
    // After a failure, a pause. Throws where it has lasted too long.
    void wait(const std::string& why) {
        if (program_.frames != frames_) from_ = Clock::now();
        ran_ |= program_.frames != frames_;
        frames_ = program_.frames;
        if (seconds_since(from_) > program_.options.retry_s)
            throw RuntimeFailure(fmt::format("the headset's runtime does not come back: {}", why));
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
    bool has_run() const { return ran_ || program_.frames != frames_; }

  private:
    const Program& program_;
    uint64_t frames_;
    bool ran_ = false;
    Clock::time_point from_ = Clock::now();
};

// Sessions on one runtime, until the user leaves. Throws XrFailure where the runtime is lost.
void run_sessions(Program& program, OnRuntime& at) {
    say(fmt::format("{}, \"{}\", on {}", at.runtime.name(), at.runtime.headset(), at.device.summary().name));
    for (RetryLimit retries(program);;) {
        std::string why = "every session ends";
        try {
            if (run_session(program, at) == xr::SessionDoes::kEnd) return tell_validation(at.device);
        } catch (const xr::XrFailure& failure) {
            program.interaction.holding.put_down(program.on);
            if (!is_session_loss(failure) || !retries.has_run()) throw;
            why = failure.what();
        }
        tell_validation(at.device);
        if (stop_requested() || program.leaves) return;
        program.on.editor.notify("the headset's session was lost; another one begins");
        program.notify();
        retries.wait(why);
    }
}

void run_runtimes(Program& program) {
    for (RetryLimit retries(program);;) {
        std::string why;
        try {
            OnRuntime at(program);
            run_sessions(program, at);
            return;
        } catch (const xr::XrFailure& failure) {
            program.interaction.holding.put_down(program.on);
            if (!is_instance_loss(failure) || !retries.has_run()) throw;
            why = failure.what();
            say("the headset's runtime was lost; waiting for it");
        } catch (const RuntimeFailure& failure) {
            if (!retries.has_run()) throw;
            why = failure.what();
        }
        if (stop_requested() || program.leaves) return;
        retries.wait(why);
    }
}

void write_report(const Program& program) {
    nlohmann::json report;
    const xr::Pose tracking = xr::inverse(xr::world_from_tracking(program.on.rig));
    for (const auto& [name, at] : program.panel_items) {
        if (!program.interaction.panel) break;
        const glm::dvec3 place = tracking * program.interaction.panel->at(at);
        report["panel"][name] = {place.x, place.y, place.z};
    }
    report["time_s"] = program.on.clock.time_s();
    report["speed"] = program.on.clock.speed;
    report["playing"] = program.on.clock.playing;
    report["stands"] = {program.on.rig.position.x, program.on.rig.position.y, program.on.rig.position.z};
    report["turned_deg"] = glm::degrees(program.on.rig.yaw_rad);
    report["modified"] = program.on.editor.modified();
    const std::string text = report.dump(1);
    write_file_atomically(program.options.report, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

}  // namespace

void watch_in_headset(const HeadsetOptions& options) {
    catch_stop_signals();
    Program program(options);
    program.open();
    if (options.mirror) program.window = std::make_unique<ui::Window>("NeuVV in a headset", ui::WindowGeometry{});
    const auto keep = [&] {
        program.finish();
        program.jobs.stop();
        try {
            program.settings.save(program.on, program.interaction.holding.settings);
        } catch (const RuntimeFailure& failure) {
            say(failure.what());
        }
        if (program.saver->autosave.store_now())
            say(fmt::format("unsaved edits are kept: `neuvv xr '{0}' --recover` or `neuvv view '{0}'` takes them",
                            options.file.string()));
    };
    try {
        run_runtimes(program);
    } catch (...) {
        keep();
        throw;
    }
    keep();
    if (!options.report.empty()) write_report(program);
}

}  // namespace neuvv::headset

#include "tools/headset/headset.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/platform.h"
#include "tools/headset/chosen.h"
#include "tools/headset/hand_shapes.h"
#include "tools/headset/mirror.h"
#include "tools/headset/panel.h"
#include "tools/headset/panel_surface.h"
#include "tools/options.h"
#include "tools/viewer/open_file.h"
#include "xr/actions.h"

namespace neuvv::headset {

namespace {

using Clock = std::chrono::steady_clock;
constexpr double kNotice_s = 6, kMostStep_s = 0.25, kFinish_s = 60;
constexpr double kShare = 0.85;  // of a period of the display that drawing may take
constexpr int32_t kAhead = 2;    // pictures of the clip whose slices are made ahead

double seconds_since(Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
}

void say(const std::string& line) {
    fmt::print(stderr, "{}\n", line);
}

// What outlives sessions and runtimes.
struct Visit {
    explicit Visit(const HeadsetOptions& wanted)
        : options(wanted), work([this](const std::string& problem) { on.editor.tell(problem, true); }, [] {}) {}

    const HeadsetOptions& options;
    OnStage on;
    viewer::Work work;
    Interaction interaction = Interaction(work);
    Chosen chosen = Chosen(config_folder().empty() ? "" : config_folder() / "headset.json");
    std::optional<Keeper> keeper;
    std::vector<viewer::Notice> notices;
    std::unique_ptr<viewer::Window> window;  // of the mirror
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
    void tell();
    void finish();
};

void Visit::open() {
    const std::filesystem::path stage = viewer::stage_of_file(options.file);
    std::optional<edit::RecoveryEntry> lost = lost_edits(stage);
    if (lost && !options.recover) {
        say(fmt::format("unsaved edits of {} are kept: --recover takes them", stage.string()));
        lost.reset();
    }
    if (lost) on.editor.tell("unsaved edits of an earlier run are taken: save keeps them");
    if (lost && edit::has_anothers_file(*lost))
        on.editor.tell("the stage's file has changed since: saving keeps that beside it");
    on.editor.open(lost ? edit::restore(*lost) : viewer::open_document(options.file), lost.has_value());
    on.follow_document();
    chosen.load(on, interaction.holding.settings);
    on.clock.playing = options.play;
    on.look_at_instant();
    keeper.emplace(on, work, lost);
}

// What is held is put down, and what is being painted or saved comes to its end.
void Visit::finish() {
    interaction.holding.put_down(on);
    interaction.brush.end_stroke(on);
    const Clock::time_point from = Clock::now();
    do {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        work.run_told();
        on.follow_document();
        interaction.brush.lay(on);
    } while ((!work.idle() || work.has_told() || interaction.brush.busy()) && seconds_since(from) < kFinish_s);
    tell();
}

// Unsaved edits are not lost, but whoever leaves should know of them.
void Visit::leave() {
    leaves = !on.editor.modified() || keeper->saving() || now_s() < asked_until_s;
    if (leaves) return;
    asked_until_s = now_s() + kNotice_s;
    on.editor.tell("not saved: Leave once more keeps the edits for --recover", true);
}

// Notices are shown for a while, and said on the terminal.
void Visit::tell() {
    for (viewer::Notice& notice : on.editor.take_notices()) {
        say(notice.text);
        notice.until_s = now_s() + kNotice_s;
        notices.push_back(std::move(notice));
    }
    std::erase_if(notices, [&](const viewer::Notice& notice) { return notice.until_s < now_s(); });
}

// A stage on a device, for as long as the runtime lives that made it.
struct OnRuntime {
    explicit OnRuntime(Visit& of);
    void follow(Visit& visit);

    xr::Runtime runtime;
    gpu::Device device;
    // Of all clips that were ever on stage, as read last: undoing a deletion in a session must not read one.
    std::map<std::filesystem::path, std::shared_ptr<const render::Field>> fields;
    std::unique_ptr<render::StageLoader> loader;
    std::unique_ptr<render::StageRenderer> renderer;  // made for the first session's images
    std::shared_ptr<const stage::Stage> drawn;
};

OnRuntime::OnRuntime(Visit& of)
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

void OnRuntime::follow(Visit& visit) {
    visit.on.follow_document();
    if (drawn == visit.on.stage) return;
    try {
        renderer->change(*visit.on.stage, loader->load(*visit.on.stage));
    } catch (const InputError& error) {  // a clip or a layer that is not there: the last edit cannot be shown
        visit.on.stage = drawn;
        return visit.on.editor.take_back(error.what());
    }
    drawn = visit.on.stage;
    know_clips(visit.on, *this);
}

void tell_validation(const gpu::Device& device) {
    for (const std::string& message : device.drain_validation_messages()) say("validation: " + message);
}

// A session's images and hands.
struct InSession {
    InSession(Visit& visit, OnRuntime& at)
        : session(at.runtime, at.device),
          actions(session),
          fingers(session),
          eyes(at.device, session, visit.options.quality),
          panel(at.device, session) {}
    xr::Session session;
    xr::Actions actions;
    xr::HandTracking fingers;
    EyeImages eyes;
    PanelSurface panel;
    std::unique_ptr<Mirror> mirror;
    xr::EyeShapes shapes;
    XrTime last_display = 0;
    double pictures_a_second = 0;
};

void make_renderer(Visit& visit, OnRuntime& at, const EyeImages& eyes) {
    if (at.renderer) return;
    const render::PaintSource paint = [&visit](const std::filesystem::path& path, const voctree::PaintedField&) {
        const auto& edited = visit.on.editor.document().paint;
        const auto found = edited.find(stage::absolute_path(path));
        return found != edited.end() ? found->second : nullptr;
    };
    at.drawn = visit.on.stage;
    at.loader = std::make_unique<render::StageLoader>(at.device, paint);
    at.renderer =
        std::make_unique<render::StageRenderer>(at.device, *at.drawn, at.loader->load(*at.drawn), eyes.capacity());
    know_clips(visit.on, at);
    visit.on.look_at_instant();
    if (!visit.placed) visit.on.floor_m = floor_of(visit.on);  // later it stays, with who stands on it
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
std::vector<render::NextSlice> slices_ahead(const Visit& visit, const render::StageRenderer& renderer) {
    std::vector<render::NextSlice> next;
    if (!visit.on.clock.playing) return next;
    for (int32_t n = 1; n <= kAhead; n++)
        for (const render::Instance& instance :
             renderer.settings_at(stage::stage_at(*visit.on.stage, visit.on.clock.shown_after_s(n))).instances)
            next.push_back({{instance.frame, instance.paint}, instance.field});
    return next;
}

// Hands, time and edits up to the instant at which this frame is seen.
void live(Visit& visit, OnRuntime& at, InSession& in, const xr::FrameTime& time, double dt_s) {
    OnStage& on = visit.on;
    xr::HandInputs inputs = in.actions.sample(time.display);
    in.fingers.locate(time.display);
    for (const int hand : {xr::kLeft, xr::kRight}) xr::stand_in(inputs[hand], in.fingers.joints(hand));
    const auto head = in.session.locate(in.session.head_space(), time.display);
    if (head) visit.head = *head;
    if (head && !visit.placed) {
        on.rig = first_rig(on, *head);
        visit.placed = true;
    }
    visit.work.run_told();
    at.follow(visit);  // what is edited from here on is seen in the next frame
    on.clock.tick(dt_s);
    on.look_at_instant();
    if (visit.head) visit.interaction.update(on, inputs, *visit.head, dt_s);
    for (const int hand : {xr::kLeft, xr::kRight})
        if (const double pulse = visit.interaction.hands[hand].pulse; pulse > 0) in.actions.pulse(hand, pulse, 0.03);
    visit.keeper->tick(visit.now_s());
    visit.tell();
}

void draw_panel_of(Visit& visit, InSession& in, double dt_s) {
    if (!visit.interaction.panel) return;
    PanelAsks asks;
    const PanelFacts facts{visit.notices, in.pictures_a_second, in.eyes.scale(), visit.keeper->saving()};
    if (visit.on.is_behind() && in.panel.has_picture()) return;  // hands have edited what it shows: as it was
    const PanelPointer pointer = visit.interaction.panel_pointer();
    in.panel.draw(pointer, dt_s, [&] { asks = draw_panel(visit.on, visit.interaction, facts); });
    visit.panel_items = asks.items;
    if (asks.save) visit.keeper->save();
    if (asks.leave) visit.leave();
}

// The stage as it is now for both eyes. False: there is nothing to be shown yet.
bool draw_eyes(Visit& visit, OnRuntime& at, InSession& in, const xr::FrameTime& time) {
    OnStage& on = visit.on;
    const bool hides_room = at.runtime.blend_mode() == XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    at.renderer->show(on.instant, hides_room);
    const xr::Pose world = xr::world_from_tracking(on.rig);
    const auto head = in.session.locate(in.session.head_space(), time.display);
    in.shapes.begin(world * (head ? head->position : glm::dvec3(0)), in.eyes.pixel_rad());
    if (hides_room) draw_floor(in.shapes, on);
    draw_interaction(in.shapes, on, visit.interaction);
    for (const int hand : {xr::kLeft, xr::kRight})
        if (visit.interaction.hands[hand].input.bare) draw_joints(in.shapes, in.fingers.joints(hand), world);
    const std::vector<render::NextSlice> next = slices_ahead(visit, *at.renderer);
    // As late as may be: all that does not depend on where the head is has been done.
    const auto eyes = in.session.locate_eyes(time.display);
    if (!eyes) return false;
    in.eyes.draw(*at.renderer, on.instant, *eyes, world, next, in.shapes, visit.interaction.walking.vignette(),
                 kShare * static_cast<double>(time.period) / 1e6);
    return true;
}

void frame(Visit& visit, OnRuntime& at, InSession& in) {
    const xr::FrameTime time = in.session.wait();
    const double dt_s = in.last_display > 0
                            ? std::clamp(static_cast<double>(time.display - in.last_display) / 1e9, 0.0, kMostStep_s)
                            : 0;
    in.last_display = time.display;
    if (dt_s > 0) in.pictures_a_second += 0.1 * (1 / dt_s - in.pictures_a_second);
    in.session.begin();
    live(visit, at, in, time, dt_s);
    std::vector<const XrCompositionLayerBaseHeader*> layers;
    if (time.render) {
        draw_panel_of(visit, in, dt_s);
        if (draw_eyes(visit, at, in, time)) {
            const auto& panel = visit.interaction.panel;
            if (panel)
                layers.push_back(in.panel.layer(
                    in.session, xr::inverse(xr::world_from_tracking(visit.on.rig)) * panel->world, panel->size_m));
            layers.push_back(in.eyes.layer(in.session, panel.has_value()));
        }
    }
    in.session.end(time, layers);
    visit.frames += !layers.empty();
    if (in.mirror && !in.mirror->show(in.eyes.left())) visit.leaves = true;
}

void ask_for_rate(const Visit& visit, InSession& in) {
    if (!visit.options.refresh_hz) return;
    const std::vector<float> rates = in.session.refresh_rates();
    if (rates.empty()) return say("the runtime's refresh rate cannot be chosen");
    const auto wanted = static_cast<float>(*visit.options.refresh_hz);
    const float nearest = *std::min_element(
        rates.begin(), rates.end(), [&](float a, float b) { return std::abs(a - wanted) < std::abs(b - wanted); });
    in.session.request_refresh_rate(nearest);
}

// Until it ends. kLost: another session may be begun.
xr::SessionDoes run_session(Visit& visit, OnRuntime& at) {
    InSession in(visit, at);
    make_renderer(visit, at, in.eyes);
    in.actions.look_at_controllers();
    if (visit.window) in.mirror = std::make_unique<Mirror>(at.device, *visit.window, in.eyes.size());
    bool asked = false, rated = false;
    for (;;) {
        xr::SessionNews news;
        const xr::SessionDoes does = in.session.poll(news);
        hear(news, in);
        if (does == xr::SessionDoes::kEnd || does == xr::SessionDoes::kLost) {
            visit.interaction.holding.put_down(visit.on);
            return does;
        }
        if ((visit.leaves || stop_requested()) && !std::exchange(asked, true)) in.session.request_exit();
        if (does == xr::SessionDoes::kWait) {
            visit.work.run_told();
            visit.keeper->tick(visit.now_s());
            visit.tell();
            if (in.mirror && !in.mirror->show(in.eyes.left())) visit.leaves = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            continue;
        }
        if (!std::exchange(rated, true)) ask_for_rate(visit, in);
        frame(visit, at, in);
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
class Patience {
  public:
    explicit Patience(const Visit& visit) : visit_(visit), frames_(visit.frames) {}
    // After a failure, a pause. Throws where it has lasted too long.
    void wait(const std::string& why) {
        if (visit_.frames != frames_) from_ = Clock::now();
        ran_ |= visit_.frames != frames_;
        frames_ = visit_.frames;
        if (seconds_since(from_) > visit_.options.retry_s)
            throw RuntimeFailure(fmt::format("the headset's runtime does not come back: {}", why));
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
    bool has_run() const { return ran_ || visit_.frames != frames_; }

  private:
    const Visit& visit_;
    uint64_t frames_;
    bool ran_ = false;
    Clock::time_point from_ = Clock::now();
};

// Sessions on one runtime, until the user leaves. Throws XrFailure where the runtime is lost.
void run_sessions(Visit& visit, OnRuntime& at) {
    say(fmt::format("{}, \"{}\", on {}", at.runtime.name(), at.runtime.headset(), at.device.summary().name));
    for (Patience patience(visit);;) {
        std::string why = "every session ends";
        try {
            if (run_session(visit, at) == xr::SessionDoes::kEnd) return tell_validation(at.device);
        } catch (const xr::XrFailure& failure) {
            visit.interaction.holding.put_down(visit.on);
            if (!is_session_loss(failure) || !patience.has_run()) throw;
            why = failure.what();
        }
        tell_validation(at.device);
        if (stop_requested() || visit.leaves) return;
        visit.on.editor.tell("the headset's session was lost; another one begins");
        visit.tell();
        patience.wait(why);
    }
}

void run_runtimes(Visit& visit) {
    for (Patience patience(visit);;) {
        std::string why;
        try {
            OnRuntime at(visit);
            run_sessions(visit, at);
            return;
        } catch (const xr::XrFailure& failure) {
            visit.interaction.holding.put_down(visit.on);
            if (!is_instance_loss(failure) || !patience.has_run()) throw;
            why = failure.what();
            say("the headset's runtime was lost; waiting for it");
        } catch (const RuntimeFailure& failure) {
            if (!patience.has_run()) throw;
            why = failure.what();
        }
        if (stop_requested() || visit.leaves) return;
        patience.wait(why);
    }
}

void write_report(const Visit& visit) {
    nlohmann::json report;
    const xr::Pose tracking = xr::inverse(xr::world_from_tracking(visit.on.rig));
    for (const auto& [name, at] : visit.panel_items) {
        if (!visit.interaction.panel) break;
        const glm::dvec3 place = tracking * visit.interaction.panel->at(at);
        report["panel"][name] = {place.x, place.y, place.z};
    }
    report["time_s"] = visit.on.clock.time_s();
    report["speed"] = visit.on.clock.speed;
    report["playing"] = visit.on.clock.playing;
    report["stands"] = {visit.on.rig.position.x, visit.on.rig.position.y, visit.on.rig.position.z};
    report["turned_deg"] = glm::degrees(visit.on.rig.yaw_rad);
    report["modified"] = visit.on.editor.modified();
    const std::string text = report.dump(1);
    write_file_atomically(visit.options.report, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

}  // namespace

void watch_in_headset(const HeadsetOptions& options) {
    catch_stop_signals();
    Visit visit(options);
    visit.open();
    if (options.mirror) visit.window = std::make_unique<viewer::Window>("NeuVV in a headset", viewer::WindowPlace{});
    const auto keep = [&] {
        visit.finish();
        visit.work.stop();
        try {
            visit.chosen.save(visit.on, visit.interaction.holding.settings);
        } catch (const RuntimeFailure& failure) {
            say(failure.what());
        }
        if (visit.keeper->store_now())
            say(fmt::format("unsaved edits are kept: `neuvv xr '{0}' --recover` or `neuvv view '{0}'` takes them",
                            options.file.string()));
    };
    try {
        run_runtimes(visit);
    } catch (...) {
        keep();
        throw;
    }
    keep();
    if (!options.report.empty()) write_report(visit);
}

}  // namespace neuvv::headset

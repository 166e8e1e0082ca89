#include "tools/headset/session_context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/headset/hands/hand_shapes.h"
#include "tools/headset/panel/panel.h"
#include "tools/headset/sound.h"
#include "tools/headset/state/next_document.h"
#include "tools/headset/state/performer_edits.h"

namespace neuvv::headset {

namespace {

constexpr double kMaxStep_s = 0.25;
constexpr double kDrawShare = 0.85;       // the share of the display's period that drawing may take
constexpr int32_t kPrefetchedFrames = 2;  // frames whose slices are built before they are shown

// The times of the next kPrefetchedFrames frames of the stage, while it plays.
std::vector<double> next_times(const editor::StageClock& clock) {
    std::vector<double> times;
    for (int32_t n = 1; clock.playing && n <= kPrefetchedFrames; ++n) times.push_back(clock.displayed_after_s(n));
    return times;
}

// The wearer's body, where it is compared.
std::optional<motion::Pose> locate_body(Program& program, SessionContext& session, const xr::HandInputs& inputs,
                                        const std::optional<xr::Pose>& head, const xr::FrameTime& time) {
    if (!program.coaching.needs_body()) return std::nullopt;
    if (!session.body) {
        session.body.emplace(session.xr_session, session.actions, session.hand_tracking);
        program.state.editor.notify(fmt::format("your body: {}", xr::title_of(session.body->source())));
    }
    return session.body->locate(inputs, head, program.state.rig, time.display);
}

// The head's last pose before the change. Some runtimes move the space before they say so.
xr::Pose head_before(const xr::TrackingChange& change, const Program& program, const SessionContext& session,
                     XrTime now) {
    constexpr XrDuration kRecent_ns = 1'000'000'000;
    const auto& jump = session.head_jump;
    return !change.old_from_new && jump && now - jump->at < kRecent_ns ? jump->from : *program.head;
}

// Follows the tracked head: the user gets a position on the stage, and keeps it where the tracking space changes.
void place_user(Program& program, SessionContext& session, const xr::FrameTime& time, const xr::Pose& head) {
    constexpr double kJump_m = 0.3;  // no head moves so far in a frame
    if (program.head && glm::distance(program.head->position, head.position) > kJump_m)
        session.head_jump = {time.display, *program.head};
    auto& change = session.tracking_change;
    if (change && time.display >= change->from) {
        // In the user's own room, performers stay where they stand in it, if the runtime knows where that is.
        change->by_user &= !(program.state.shows_room && change->old_from_new);
        if (program.head && program.start && (change->by_user || change->moves())) {
            follow_tracking_change(program.state, *change, head_before(*change, program, session, time.display), head);
            program.interaction.user_was_moved(program.state);
        }
        change.reset();
    }
    program.head = head;
    if (program.start) return;
    program.start = first_place(program.state);
    stand_at(program.state, *program.start, head);
}

// The user comes to the first place of a stage that was opened in place of another one.
void enter_stage(Program& program) {
    program.state.floor_m = editor::floor_of(program.state);
    program.start = first_place(program.state);
    stand_at(program.state, *program.start, *program.head);
    program.interaction.user_was_moved(program.state);
    program.interaction.locomotion.fade_in();
}

// What hands feel: an error in both, and else what each has done.
void vibrate(const Program& program, SessionContext& session) {
    for (const int role : {xr::kLeft, xr::kRight}) {
        const int hand = program.state.hand_of(role);
        const double pulse = program.interaction.hands[role].vibration;
        if (program.notice_plate.pulse_begins())
            session.actions.vibrate(hand, 1, NoticePlate::kPulse_s);
        else if (pulse > 0 && !program.notice_plate.is_pulsing())
            session.actions.vibrate(hand, pulse, 0.03);
    }
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
    if (head) place_user(program, session, time, *head);
    program.jobs.run_posted();
    context.follow(program);  // edits that are made after this show in the next frame
    state.clock.tick(dt_s);
    state.evaluate();
    context.update_solid(state);
    if (!program.start && program.head) enter_stage(program);
    program.coaching.turn_trainer(state, dt_s);
    if (program.head) {
        program.interaction.update(state, inputs, *program.head, dt_s, [&](std::span<const Ray> rays) {
            return context.find_surfaces(state.evaluated, rays);
        });
        program.coaching.update(state, locate_body(program, session, inputs, head, time),
                                xr::world_from_tracking(state.rig) * program.head->position);
    }
    if (program.head) play_sound(state, program.sound, *program.head);
    program.saver->autosave.tick(program.now_s());
    program.notify();
    if (program.head)
        program.notice_plate.update(xr::world_from_tracking(state.rig) * *program.head, program.interaction.panel,
                                    dt_s);
    vibrate(program, session);
}

void update_panel(Program& program, SessionContext& session, double dt_s) {
    if (!program.interaction.panel) return;
    PanelResult result;
    const PanelStatus status{program.notices,         session.images_per_second,         session.eyes.scale(),
                             program.saver->saving(), program.head.value_or(xr::Pose()), session.room_m};
    if (program.state.is_behind() && session.panel.has_image())
        return;  // hands have edited the document: its nodes do not match the stage
    const PanelPointer pointer = program.interaction.panel_pointer();
    session.panel.draw(pointer, dt_s,
                       [&] { result = draw_panel(program.state, program.interaction, program.coaching, status); });
    program.panel_items = result.items;
    if (result.save && !program.saver->saving()) program.saver->save(program.saver->default_path());
    if (result.save_as && !program.saver->saving()) {
        const std::filesystem::path path = program.saver->default_path();
        program.saver->save(std::filesystem::exists(path) ? next_numbered(path) : path);
    }
    if (!result.open.empty()) open_other(program.state, program.jobs, result.open);
    if (result.leave) program.leave();
    if (result.to_start && program.head && program.start) {
        stand_at(program.state, *program.start, *program.head);
        program.interaction.user_was_moved(program.state);
        program.interaction.locomotion.fade_in();
    }
}

// Shows or hides the user's own room, as the user wants it; where that was not said yet, as the runtime prefers it.
void update_room(Program& program, RuntimeContext& context, SessionContext& session) {
    HeadsetState& state = program.state;
    const bool prefers = context.runtime.blend_modes()[0] != XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
    const bool wanted = state.wants_room.value_or(prefers) && !state.refused_room;
    session.room.show(wanted);
    state.shows_room = session.room.is_shown();
    program.room = state.shows_room ? session.room.view() : xr::RoomView::kNone;
    if (!wanted || state.shows_room) return;
    state.editor.notify(
        "this headset cannot show your room: its runtime offers neither XR_FB_passthrough nor "
        "a blend mode for that");
    state.refused_room = true;
}

// The point at which the eyes look; nothing where that is not known. How far away it is makes little difference to
// where it is in their images.
std::optional<glm::dvec3> find_gaze(const SessionContext& session, const xr::Pose& world, const xr::FrameTime& time) {
    constexpr double kDistance_m = 2;
    const auto gaze = session.actions.locate_gaze(time.display);
    if (!gaze) return std::nullopt;
    return world * (*gaze * glm::dvec3(0, 0, -kDistance_m));
}

// What is read, and how long the last image took.
std::vector<std::string> status_lines(const Program& program, const RuntimeContext& context,
                                      const SessionContext& session, const xr::FrameTime& time) {
    std::vector<std::string> lines;
    if (const auto& performer = program.state.new_performer; performer && !performer->is_read)
        lines.push_back(fmt::format("reading {}", performer->clip.filename().string()));
    if (const auto& next = program.state.next_document) {
        lines.push_back(fmt::format("opening {}", next->path.filename().string()));
        if (next->clips > 1) lines.push_back(fmt::format("{} of {} clips", next->clips_read, next->clips));
    }
    if (!program.state.shows_frame_times) return lines;
    lines.push_back(fmt::format("{:.1f} ms of {:.1f}", context.renderer->frames().device_milliseconds(),
                                static_cast<double>(time.period) / 1e6));
    const double scale = session.eyes.scale();
    lines.push_back(fmt::format("{:.0f} a second, {:.0f} % of rays", session.images_per_second, 100 * scale * scale));
    return lines;
}

void draw_labels(Program& program, const RuntimeContext& context, SessionContext& session, const xr::FrameTime& time,
                 const xr::Pose& world_head) {
    const HeadsetState& state = program.state;
    draw_status(session.shapes, session.font, status_lines(program, context, session, time), world_head);
    if (std::exchange(program.hints_left_handed, state.left_handed) != state.left_handed)
        program.hints = make_hints(session.actions, state);
    draw_hints(session.shapes, session.font, state, program.interaction, program.hints, world_head);
    draw_names(session.shapes, session.font, state, program.interaction, world_head);
    const NoticePlate& plate = program.notice_plate;
    const std::vector<std::string_view> lines(plate.lines().begin(), plate.lines().end());
    if (!lines.empty()) session.font.draw(session.shapes, plate.world_from_plate(), plate.line_m(), lines);
}

// Draws the stage for all views. Returns false while the poses of the eyes are not known.
bool draw_eyes(Program& program, RuntimeContext& context, SessionContext& session, const xr::FrameTime& time) {
    HeadsetState& state = program.state;
    const xr::Pose world = xr::world_from_tracking(state.rig);
    const bool hides_room = !session.room.is_shown();
    session.eyes.show_room(!hides_room);
    context.renderer->show_room(hides_room ? std::nullopt : std::optional(world.position.y));
    context.renderer->show(state.evaluated, hides_room, render::MissingSegments::kHold);
    for (const Note& problem : context.renderer->take_problems()) print_line("not shown: " + problem.words());
    const auto head = session.xr_session.locate(session.xr_session.head_space(), time.display);
    session.shapes.begin(world * (head ? head->position : glm::dvec3(0)), session.eyes.pixel_rad());
    if (hides_room) draw_floor(session.shapes, state);
    draw_guide(session.shapes, program.coaching.session().guide());
    draw_interaction(session.shapes, state, program.interaction);
    if (program.head) draw_labels(program, context, session, time, world * *program.head);
    for (const int hand : {xr::kLeft, xr::kRight})
        if (program.interaction.hands[state.hand_of(hand)].input.bare_hand)
            draw_joints(session.shapes, session.hand_tracking.joints(hand), world);
    const std::vector<render::Instance> next = context.renderer->instances_at(next_times(state.clock));
    // As late as possible, for the newest prediction: all that does not depend on the head has been done before.
    const auto eyes = session.xr_session.locate_eyes(time.display);
    if (!eyes) return false;
    session.eyes.look_at(find_gaze(session, world, time));
    xr::EyeShade shade = program.interaction.locomotion.shade();
    if (!hides_room) shade.fade = 0;  // the user's own room does not jump
    session.eyes.draw(*context.renderer, state.evaluated, program.coaching.session().highlight(), *eyes, world, next,
                      session.shapes, shade, kDrawShare * static_cast<double>(time.period) / 1e6);
    return true;
}

}  // namespace

void handle_events(const xr::SessionEvents& events, Program& program, SessionContext& session) {
    program.is_worn = events.is_worn.value_or(program.is_worn);
    program.has_focus = events.has_focus.value_or(program.has_focus);
    if (events.is_worn || events.has_focus) program.pause_unattended();
    if (events.passthrough_lost) session.room.restart();
    session.tracking_change = events.tracking_change;
    if (events.controllers_changed) {
        session.actions.update_controllers();
        program.hints = make_hints(session.actions, program.state);
        for (const int hand : {xr::kLeft, xr::kRight})
            if (const std::string controller = session.actions.controller(hand); !controller.empty())
                print_line(fmt::format("{} hand: {}", hand == xr::kLeft ? "left" : "right", controller));
    }
    for (uint32_t view = 0; view < session.xr_session.runtime().view_count(); ++view)
        if (events.mask_changed[view]) session.eyes.invalidate_mask(view);
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
    update_room(program, context, session);
    if (time.should_render) {
        update_panel(program, session, dt_s);
        if (draw_eyes(program, context, session, time)) {
            const auto& panel = program.interaction.panel;
            if (const auto* room = session.room.layer()) layers.push_back(room);
            if (panel)
                layers.push_back(session.panel.layer(
                    session.xr_session,
                    xr::inverse(xr::world_from_tracking(program.state.rig)) * panel->world_from_panel, panel->size_m));
            layers.push_back(session.eyes.layer(session.xr_session, panel || session.room.is_shown()));
        }
    }
    session.xr_session.end_frame(time, session.room.blend_mode(), layers);
    program.frames += !layers.empty();
    if (!session.mirror) return;
    std::optional<MirroredPanel> panel;
    if (program.interaction.panel) panel = {*program.interaction.panel, session.eyes.left_camera()};
    if (!session.mirror->show(session.eyes.left(), panel)) program.leaving = true;
}

}  // namespace neuvv::headset

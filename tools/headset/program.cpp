#include "tools/headset/program.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "editor/open_file.h"
#include "tools/say.h"

namespace neuvv::headset {

namespace {

constexpr double kNotice_s = 6, kFinish_s = 60;

}  // namespace

double seconds_since(Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
}

void print_line(const std::string& line) {
    tools::say("{}\n", line);
}

void Program::open() {
    const std::filesystem::path stage = editor::stage_of_file(options.file);
    opened = options.file;
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
    if (options.room) state.wants_room = true;
    if (!options.trainee.empty())
        coaching.begin(state, coach::read_trainer(*state.stage, ""), motion::open_pose_source(options.trainee));
    state.evaluate();
    saver.emplace(state.editor, jobs);
    saver->autosave.opened(std::move(recovered));
}

std::string without_node_numbers(std::string notice) {
    constexpr std::string_view kBefore = " (node ";
    for (size_t at = notice.find(kBefore); at != std::string::npos; at = notice.find(kBefore, at)) {
        const size_t end = notice.find_first_not_of("0123456789", at + kBefore.size());
        const bool is_number = end != std::string::npos && end > at + kBefore.size() && notice[end] == ')';
        if (is_number)
            notice.erase(at, end + 1 - at);
        else
            ++at;
    }
    return notice;
}

void Program::finish() {
    interaction.release_all(state);
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

bool Program::open_next() {
    std::optional<NextDocument>& next = state.next_document;
    const bool is_busy = interaction.is_holding() || interaction.painter.is_busy() || state.new_performer;
    if (!next || !next->is_read || is_busy) return false;
    if (state.editor.modified()) {  // by an edit that was made meanwhile
        state.editor.notify("not opened: the stage was edited meanwhile", true);
        next.reset();
        return false;
    }
    interaction.release_all(state);
    interaction.painter.clear_region();
    coaching.end(state);
    opened = next->path;
    saver->autosave.opened();
    state.editor.open(std::move(*next->document), false);
    const bool plays = state.clock.playing || paused;
    state.clock = editor::StageClock();
    state.clock.playing = plays && !paused;
    state.dialogue = PanelDialogue::kNone;
    next.reset();
    start.reset();
    return true;
}

void Program::pause_unattended() {
    if (is_worn && has_focus)
        state.clock.playing |= std::exchange(paused, false);
    else
        paused |= std::exchange(state.clock.playing, false);
}

void Program::keep_window_alive() {
    if (!window) return;
    window->poll();
    leaving |= window->close_requested();
}

void Program::leave() {
    leaving = !state.editor.modified() || saver->saving() || now_s() < confirm_until_s;
    if (leaving) return;
    confirm_until_s = now_s() + kNotice_s;
    state.editor.notify("not saved: Leave once more keeps the edits for --recover", true);
}

void Program::notify() {
    for (editor::Notice& notice : state.editor.take_notices()) {
        print_line(notice.text);
        notice.text = without_node_numbers(std::move(notice.text));
        notice.until_s = now_s() + kNotice_s;
        notice_plate.show(notice);
        notices.push_back(std::move(notice));
    }
    std::erase_if(notices, [&](const editor::Notice& notice) { return notice.until_s < now_s(); });
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
    if (program.head) {
        const xr::Pose head = xr::world_from_tracking(program.state.rig) * *program.head;
        report["head"] = {{"at", {head.position.x, head.position.y, head.position.z}},
                          {"heading_deg", glm::degrees(xr::yaw_of(head.rotation))}};
    }
    report["room"] = program.room == xr::RoomView::kNone ? "hidden" : xr::title_of(program.room);
    report["coach"] = program.coaching.facts();
    if (const auto performer = program.state.selected_performer())
        report["selected"] = program.state.stage->performers[*performer].name;
    for (const int role : {xr::kLeft, xr::kRight}) {
        const auto [lines, count] = shown_hints(program.state, program.interaction, program.hints, role);
        report["hints"][program.state.hand_of(role) == xr::kLeft ? "left" : "right"] =
            std::vector<std::string>(lines.data(), lines.data() + count);
    }
    report["notice"] = program.notice_plate.lines();
    report["modified"] = program.state.editor.modified();
    report["stage"] = program.state.editor.file().path.string();
    const std::string text = report.dump(1);
    write_file_atomically(program.options.report, [&](const ByteSink& sink) { sink(text.data(), text.size()); });
}

}  // namespace neuvv::headset

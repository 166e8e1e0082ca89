// What outlives sessions and runtimes: the document with its stage, its history and time, the user and what hands do.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/platform.h"
#include "base/threads/job_queue.h"
#include "editor/document_saver.h"
#include "editor/sound_player.h"
#include "tools/headset/draw/notice_plate.h"
#include "tools/headset/hands/interaction.h"
#include "tools/headset/hands/labels.h"
#include "tools/headset/headset.h"
#include "tools/headset/settings.h"
#include "tools/headset/standing.h"
#include "tools/headset/state/coaching.h"
#include "tools/ui/window.h"
#include "xr/room.h"

namespace neuvv::headset {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point from);
// To stderr.
void print_line(const std::string& line);

struct Program {
    explicit Program(const HeadsetOptions& given)
        : options(given), jobs([this](const std::string& problem) { state.editor.notify(problem, true); }, [] {}) {}

    const HeadsetOptions& options;
    HeadsetState state;
    JobQueue jobs;
    editor::SoundPlayer sound;
    Interaction interaction = Interaction(jobs);
    Coaching coaching = Coaching(jobs);
    HeadsetSettings settings = HeadsetSettings(config_folder().empty() ? "" : config_folder() / "headset.json");
    std::optional<editor::DocumentSaver> saver;
    std::vector<editor::Notice> notices;
    NoticePlate notice_plate;
    std::unique_ptr<ui::Window> window;  // of the mirror; null without --mirror
    Clock::time_point began = Clock::now();
    std::filesystem::path opened;             // what the user named last
    std::optional<StandingPlace> start;       // where the user began; empty: the user has no position on the stage yet
    bool leaving = false;                     // the user wants to leave
    bool is_worn = true;                      // somebody wears the headset, as far as the runtime says
    bool has_focus = true;                    // no menu of the system is in front
    bool paused = false;                      // the stage played before one of these became false
    std::optional<xr::Pose> head;             // tracking space; the last tracked pose
    xr::RoomView room = xr::RoomView::kNone;  // how the user's own room is seen; kNone: it is not
    uint64_t frames = 0;                      // drawn since the program began
    std::map<std::string, glm::dvec2> panel_items;
    ButtonHints hints;               // of the controllers that the user holds
    bool hints_left_handed = false;  // HeadsetState::left_handed of `hints`

    double confirm_until_s = 0;  // until then, Leave leaves although there are unsaved edits

    double now_s() const { return seconds_since(began); }
    // Opens the file of the options. Throws InputError.
    void open();
    // Opens the next document in place of the present one, once it has been read and hands hold nothing. Returns
    // whether it did; then `start` is empty, as the user has no position on the new stage yet.
    bool open_next();
    // Does what the button Leave does. The recovery files keep unsaved edits; still, the first press only reports that
    // there are any.
    void leave();
    // Prints new notices, and removes those that have been on the panel for some seconds.
    void notify();
    // Pauses the stage while nobody wears the headset, or a menu of the system is in front; then it goes on if it has
    // played before.
    void pause_unattended();
    // To be called again and again while there are no frames: the window stays alive, and closing it ends the program.
    void keep_window_alive();
    // Ends grabs and strokes, and waits for unfinished strokes and files, but not for ever.
    void finish();
};

// A notice for somebody who sees no numbers of nodes: `"ben" (node 4): a copy` becomes `"ben": a copy`.
std::string without_node_numbers(std::string notice);

// Writes the report that HeadsetOptions::report asks for.
void write_report(const Program& program);

}  // namespace neuvv::headset

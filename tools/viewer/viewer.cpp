#include "tools/viewer/viewer.h"

#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/platform.h"
#include "tools/viewer/keys.h"
#include "tools/viewer/report_facts.h"

namespace neuvv::viewer {

namespace {

constexpr double kIdleWait_s = 0.5, kPlayingWait_s = 1.0 / 30, kMovingWait_s = 1.0 / 60, kFrame_s = 1.0 / 60;

std::filesystem::path preferences_file() {
    const std::filesystem::path folder = config_folder();
    return folder.empty() ? folder : folder / "viewer.json";
}

Preferences preferences_for(const Viewer::Options& options, std::string& message) {
    LoadedPreferences loaded = load_preferences(preferences_file());
    message = loaded.message;
    if (options.size) {
        loaded.preferences.window.width = static_cast<int>(options.size->width);
        loaded.preferences.window.height = static_cast<int>(options.size->height);
        loaded.preferences.window.maximised = false;
    }
    return loaded.preferences;
}

}  // namespace

Viewer::Viewer(const Options& options, const std::string& device)
    : preferences_(preferences_for(options, preferences_message_)),
      display_({preferences_.window, options.ui_scale, preferences_.ui_scale, device, options.validate,
                options.screenshots}),
      session_(display_.device(), options.report),
      panels_(display_.device()),
      tasks_(session_.context, preferences_, panels_, device, options.shaders) {
    session_.view.mode = &panels_.tools.first_mode();
    apply_preferences(session_.view, preferences_);
    if (!preferences_message_.empty()) session_.editor.notify(preferences_message_, true);
    if (!options.trainee.empty()) tasks_.coaching.begin_with_stage(options.trainee);
    if (options.file.empty())
        tasks_.files.offer_recovery();
    else
        tasks_.files.open(options.file);
}

// Jobs and tasks of the render thread use the other members, so they must end first.
Viewer::~Viewer() {
    session_.jobs.stop();
    tasks_.exporter.cancel();
    session_.render_thread.stop();
}

void Viewer::store_preferences() {
    const std::filesystem::path file = preferences_file();
    if (file.empty()) return;
    preferences_.window = display_.window.geometry();
    note_preferences(session_.view, preferences_);
    save_preferences(file, preferences_);
}

void Viewer::run() {
    try {
        while (!display_.window.close_requested()) {
            try {
                round();
            } catch (const gpu::VulkanError& error) {
                if (!error.device_lost()) throw;
                recover_device(error.what());
            }
        }
    } catch (...) {
        session_.jobs.stop();
        tasks_.files.keep_unsaved_edits();
        throw;
    }
    store_preferences();
}

// Makes the device anew, and what the window and the render thread have on it. All else stays as it is; what was drawn
// is drawn again.
void Viewer::recover_device(std::string why) {
    session_.render_thread.release();
    panels_.paint.free_surface();
    session_.input.rendered = {};
    display_.make_anew(std::move(why));
    session_.render_thread.restart();
    images_.send_again(session_.context);
    session_.editor.notify("the device was lost, and has been made anew", true);
    session_.context.redraw();
}

void Viewer::round() {
    wait();
    read_input();
    frame();
    images_.meter.end_frame(session_.input.rendered, session_.input.now_s, display_.seconds());
    session_.requests.frames = std::max(0, session_.requests.frames - 1);
    if (display_.window.close_requested() && !may_close_) ask_to_close();
}

void Viewer::ask_to_close() {
    display_.window.keep_open();
    session_.context.redraw();
    const auto close = [this] {
        tasks_.files.when_saved_or_discarded([this] {
            may_close_ = true;
            display_.window.close();
        });
    };
    if (tasks_.verb.is_running()) return tasks_.files.ask_to_stop(tasks_.verb.form().title, close);
    close();
}

// Waits until there is something to draw. A new image of the render thread, or the result of a job, ends the wait at
// once. Anything else is drawn no earlier than kFrame_s after the previous frame, so that panels leave time for tracing
// where both use the same cores.
void Viewer::wait() {
    ui::Window& window = display_.window;
    const FrameInput& input = session_.input;
    double seconds_left = kIdleWait_s;
    if (session_.view.clock.playing) seconds_left = std::min(kPlayingWait_s, session_.view.clock.until_next_s());
    if (session_.context.in_motion() || tasks_.coaching.is_running()) seconds_left = kMovingWait_s;
    if (session_.requests.frames > 0 || window.has_more()) seconds_left = 0;
    if (seconds_left > 0) window.wait(seconds_left);
    for (double left; (left = input.now_s + kFrame_s - display_.seconds()) > 0;) {
        const uint64_t drawn = session_.render_thread.state().displayed.number;
        if (drawn != input.rendered.displayed.number || session_.jobs.has_posted()) return;
        window.wait(left);
    }
}

void Viewer::read_input() {
    if (display_.read(session_.input)) session_.context.redraw();
    session_.read_render_thread();
    images_.meter.count_image(session_.input.rendered.displayed.view, session_.input.now_s);
}

void Viewer::frame() {
    Context& context = session_.context;
    editor::Editor& editor = session_.editor;
    session_.jobs.run_posted();
    panels_.notices.take(context);
    session_.receive_stage();
    display_.set_title(
        editor.is_open() ? fmt::format("{}{} – NeuVV", editor.modified() ? "• " : "", tasks_.files.name()) : "NeuVV");
    tasks_.tick(context, display_.window.dropped());
    apply_ui_scale();
    session_.report.begin_frame();
    display_.begin(session_.input);
    session_.view.clock.tick(session_.input.dt_s);  // before keys, which may start a clock that did not run until now
    handle_keys(context, {tasks_.files, display_.window, display_.screenshots, panels_.tools, panels_.tree});
    display_.screenshots.take(context, display_.screen(), images_.is_sharp(session_.input));
    session_.evaluate();
    eye_motion_.move(context);
    tasks_.coaching.tick(context);
    sound_.follow(context);
    draw_panels();
    if (editor.dragging() && !ImGui::IsAnyItemActive() && !panels_.tools.is_editing()) editor.end_drag();
    images_.send(context, tasks_.coaching.session().highlight());
    write_report();
    if (!display_.end(session_.input)) context.redraw();
    session_.render_thread.presented(session_.input.rendered.displayed.number);
}

void Viewer::apply_ui_scale() {
    if (const std::optional<float> scale = std::exchange(session_.requests.ui_scale, std::nullopt)) {
        preferences_.ui_scale =
            std::clamp(static_cast<double>(*scale) / static_cast<double>(display_.window.content_scale()), 0.5, 4.0);
        display_.screen().set_scale(*scale);
        session_.context.redraw();
    }
    session_.input.ui_scale = display_.screen().scale();
}

void Viewer::draw_panels() {
    panels_.draw(session_.context, session_.input,
                 {display_.window, display_.device(), preferences_, tasks_.files, tasks_.exporter, tasks_.verb,
                  tasks_.coaching, sound_.waveforms, images_.meter});
}

void Viewer::write_report() {
    if (!session_.report.enabled()) return;
    report_facts(session_.context, {panels_.paint, tasks_.coaching, images_.meter, display_.window,
                                    panels_.notices.all(), display_.validation_messages(), tasks_.verb,
                                    display_.title(), images_.is_still() && images_.is_sharp(session_.input)});
    if (!session_.report.end_frame()) session_.context.redraw(1);
}

}  // namespace neuvv::viewer

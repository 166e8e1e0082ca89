#include "tools/viewer/viewer.h"

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/platform.h"
#include "media/colour.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/node_actions.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/timeline/camera_path_view.h"

namespace neuvv::viewer {

namespace {

constexpr double kIdleWait_s = 0.5, kPlayingWait_s = 1.0 / 30, kMovingWait_s = 1.0 / 60, kFrame_s = 1.0 / 60;
constexpr double kStillAfter_s = 0.12, kNotice_s = 6;
constexpr size_t kMostMessages = 20, kMostNotices = 4;

double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double aspect_of(const Area& area) {
    return area.height > 0 ? area.width / area.height : 1;
}

// The eye at the first sight of a stage: through its first camera, else from the front, all in view.
Eye first_eye(const stage::Stage& stage, const stage::EvaluatedStage& evaluated, double aspect) {
    const auto [low, high] = stage::performers_box(stage, evaluated);
    for (const stage::EvaluatedCamera& camera : evaluated.cameras)
        if (!camera.orthographic)
            return looking_through(camera.world_from_camera, camera.vertical_angle_rad,
                                   distance_to(camera.world_from_camera, low, high));
    return framed(seen_from(Eye{}, EyeSide::kFront), low, high, aspect);
}

bool same_image(const editor::ViewRequest& a, const editor::ViewRequest& b) {
    return a.camera.world_from_camera == b.camera.world_from_camera && a.camera.fx == b.camera.fx &&
           a.camera.fy == b.camera.fy && a.camera.cx == b.camera.cx && a.camera.cy == b.camera.cy &&
           a.camera.width == b.camera.width && a.camera.height == b.camera.height && a.time_s == b.time_s &&
           a.resolve == b.resolve && a.own_background == b.own_background && a.moving == b.moving &&
           a.most_scale == b.most_scale && a.samples == b.samples;
}

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

// Menus and choices; questions take their Escape themselves.
void close_popup_by_escape(const Viewer& viewer) {
    const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
    if (!viewer.escape || open.empty()) return;
    const ImGuiWindow* window = open.back().Window;
    if (window && !(window->Flags & ImGuiWindowFlags_Modal)) ImGui::ClosePopupToLevel(open.Size - 1, true);
}

}  // namespace

Viewer::Viewer(const Options& options, const std::string& device_choice)
    : preferences(preferences_for(options, preferences_message_)),
      window("NeuVV", preferences.window),
      device(device_choice, options.validate ? gpu::Validation::kOn : gpu::Validation::kOff, window.extensions()),
      screen(device, window,
             options.ui_scale.value_or(static_cast<float>(preferences.ui_scale) * window.content_scale())),
      jobs([this](const std::string& problem) { editor.notify(problem, true); }, ui::Window::wake),
      render_thread(device, ui::Window::wake),
      files(*this),
      report(options.report),
      screenshots(options.screenshots),
      shader_watch(parts(), options.shaders),
      paint(device),
      begin_(std::chrono::steady_clock::now()) {
    image.most_scale = static_cast<float>(preferences.preview.resolution);
    image.samples = std::clamp(static_cast<int>(std::lround(std::sqrt(preferences.preview.samples))), 1, 4);
    if (const auto side = preferences.panels.find("side"); side != preferences.panels.end()) {
        panels.all = side->second.open;
        panels.side_width = static_cast<float>(side->second.width);
    }
    for (size_t i = 0; i < std::size(kLayerNames); i++)
        if (preferences.layer == kLayerNames[i]) image.show = static_cast<render::Show>(i);
    if (!preferences_message_.empty()) editor.notify(preferences_message_, true);
    if (options.file.empty())
        files.offer_lost();
    else
        files.open(options.file);
}

// Jobs and tasks use the other parts.
Viewer::~Viewer() {
    jobs.stop();
    if (exporting) exporting->cancel();
    render_thread.stop();
}

void Viewer::name_window() {
    std::string title = "NeuVV";
    if (editor.is_open())
        title = fmt::format("{}{} – NeuVV", editor.modified() ? "• " : "", editor.file().path.filename().string());
    if (title == title_) return;
    title_ = title;
    window.set_title(title);
}

void Viewer::keep_preferences() {
    const std::filesystem::path file = preferences_file();
    if (file.empty()) return;
    preferences.window = window.place();
    preferences.preview = {image.most_scale, static_cast<uint32_t>(image.samples * image.samples)};
    preferences.layer = kLayerNames[static_cast<size_t>(image.show)];
    preferences.panels["side"] = {panels.all, panels.side_width};
    save_preferences(file, preferences);
}

void Viewer::run() {
    while (!window.asked_to_close()) {
        const uint64_t shown_before = drawn.displayed.number;
        wait();
        const bool event = window.poll();
        const double now = seconds_since(begin_);
        came_s_.reset();
        if (event) came_s_ = std::chrono::duration<double>(window.came() - begin_).count();
        dt_s = now - now_s;
        now_s = now;
        drawn = render_thread.state();
        count_images();
        if (event) redraw();
        if (drawn.displayed.number != shown_before) redraw(1);
        frame();
        frame_ms_ = 1000 * (seconds_since(begin_) - now_s);
        if (drawn.displayed.view > 0) worst_frame_ms_ = std::max(worst_frame_ms_, frame_ms_);
        note_latency();
        frames_left_ = std::max(0, frames_left_ - 1);
        if (window.asked_to_close() && !may_close_) {
            window.keep_open();
            redraw();
            files.when_saved_or_given_up([this] {
                may_close_ = true;
                window.close();
            });
        }
    }
    keep_preferences();
}

// The mean over the last images; nothing while nothing changes.
void Viewer::count_images() {
    constexpr double kOld_s = 1;
    if (drawn.displayed.view != counted_view_) shown_s_.push_back(now_s);
    counted_view_ = drawn.displayed.view;
    while (!shown_s_.empty() && now_s - shown_s_.front() > kOld_s) shown_s_.pop_front();
    const double seconds = shown_s_.empty() ? 0 : shown_s_.back() - shown_s_.front();
    images_per_second_ = seconds > 0 ? static_cast<double>(shown_s_.size() - 1) / seconds : 0;
}

// Until there is something to show: at once what the drawer has drawn, the rest as often as screens show images, so
// that panels take little of the time of images where both are drawn by the same cores.
void Viewer::wait() {
    double seconds = kIdleWait_s;
    if (clock.playing) seconds = std::min(kPlayingWait_s, clock.until_next_s());
    if (something_goes_on()) seconds = kMovingWait_s;
    if (frames_left_ > 0 || window.has_more()) seconds = 0;
    if (seconds > 0) window.wait(seconds);
    for (double left; (left = now_s + kFrame_s - seconds_since(begin_)) > 0;) {
        if (render_thread.state().displayed.number != drawn.displayed.number || jobs.has_posted()) return;
        window.wait(left);
    }
}

bool Viewer::something_goes_on() const {
    return flight_ || now_s - last_move_s_ < kStillAfter_s;
}

void Viewer::frame() {
    jobs.run_posted();
    for (editor::Notice& notice : editor.take_notices()) {
        notice.until_s = now_s + kNotice_s;
        notices_.push_back(std::move(notice));
        redraw();
    }
    // Why nothing could be opened stays until something is.
    std::erase_if(notices_, [&](const editor::Notice& notice) {
        return notice.until_s < now_s && (editor.is_open() || !notice.error);
    });
    if (notices_.size() > kMostNotices)
        notices_.erase(notices_.begin(), notices_.end() - static_cast<std::ptrdiff_t>(kMostNotices));
    if (drawn.stage && drawn.stage != stage) {
        const bool first = !stage || stage->file.path != drawn.stage->file.path;
        stage = drawn.stage;
        clock.set_stage(stage->duration_s, stage->fps);
        evaluated = stage::stage_at(*stage, clock.shown_s());
        if (first) eye = first_eye(*stage, stage::stage_at(*stage, 0), aspect_of(image_area));
    }
    const bool can_be_taken_back = editor.dragging() || editor.history().next_undo();
    if (can_be_taken_back && drawn.unsound_id == editor.id()) editor.take_back(drawn.problem);
    name_window();
    files.tick();
    shader_watch.tick(now_s, !exporting);
    end_export();
    for (const std::filesystem::path& path : window.dropped()) files.take(path);
    if (wanted_scale) {
        preferences.ui_scale =
            std::clamp(static_cast<double>(*wanted_scale) / static_cast<double>(window.content_scale()), 0.5, 4.0);
        screen.set_scale(*std::exchange(wanted_scale, std::nullopt));
        redraw();
    }
    report.begin_frame();
    screen.begin();
    clock.tick(dt_s);  // before keys: what begins to play now has not played since the last frame
    take_keys();
    screenshots.take(*this);
    if (flight_) {
        eye = between(flight_->from, flight_->to, now_s - flight_->begin_s);
        if (now_s - flight_->begin_s > kEyeMove_s) flight_.reset();
        moves();
    }
    if (stage) evaluated = stage::stage_at(*stage, clock.shown_s());
    const uint64_t view_before = looked_ ? looked_->id : 0, stage_before = shown_document_;
    go_along_path();
    place_panels();
    if (editor.dragging() && !ImGui::IsAnyItemActive() && !holds_handle) editor.end_drag();
    if (editor.is_open() && editor.id() != shown_document_) {
        shown_document_ = editor.id();
        render_thread.show(std::make_shared<const edit::Document>(editor.document()), shown_document_);
        if (editor.dragging()) moves();
    }
    look();
    ask_latency(view_before, stage_before);
    tell_report();
    const VkRect2D at{{static_cast<int32_t>(image_area.left), static_cast<int32_t>(image_area.top)},
                      {static_cast<uint32_t>(image_area.width), static_cast<uint32_t>(image_area.height)}};
    if (!screen.end({drawn.displayed.image, drawn.displayed.size, at})) redraw();
    render_thread.taken(drawn.displayed.number);
}

// The image left, the stage and what is selected right, time below.
void Viewer::place_panels() {
    close_popup_by_escape(*this);
    menu_bar(*this);
    const ImVec2 window_size = ImGui::GetIO().DisplaySize;
    const float top = ImGui::GetFrameHeight();
    Area side, below;
    if (panels.all) {
        side.width = std::round(std::min(std::max(ui(panels.side_width), ui(180)), 0.5f * window_size.x));
        side.left = window_size.x - side.width;
        side.top = top;
        side.height = window_size.y - top;
        below.height = std::round(std::min(std::max(ui(panels.timeline_height), ui(80)), 0.5f * (window_size.y - top)));
        below.width = window_size.x - side.width;
        below.top = window_size.y - below.height;
    }
    image_area = {0, top, window_size.x - side.width, window_size.y - top - below.height};
    camera = camera_of(eye, std::max(1u, static_cast<uint32_t>(image_area.width)),
                       std::max(1u, static_cast<uint32_t>(image_area.height)));
    image_panel(*this);
    if (panels.all) {
        const float tree = std::round(panels.tree_share * side.height);
        stage_panel(*this, {side.left, side.top, side.width, tree});
        properties_panel(*this, {side.left, side.top + tree, side.width, side.height - tree});
        timeline_panel(*this, below);
    }
    if (panels.speed) speed_panel(*this);
    if (panels.help) help_panel(*this);
    notices_panel(*this);
    files.panel();
}

void Viewer::look() {
    if (!stage || camera.width < 2 || camera.height < 2) return;
    editor::ViewRequest view;
    view.camera = camera;
    view.time_s = clock.shown_s();
    view.resolve.show = image.show;
    view.resolve.cost_max = image.cost_max;
    view.own_background = image.own_background;
    view.resolve.background = glm::vec4(media::linear_from_srgb(image.background), 1);
    view.moving = clock.playing || something_goes_on() || editor.dragging();
    view.most_scale = image.most_scale;
    view.samples = static_cast<uint32_t>(image.samples);
    const auto [low, high] = stage::performers_box(*stage, evaluated);
    const double distance = distance_to(camera.world_from_camera, low, high), size = glm::length(high - low);
    view.resolve.depth_near_m = static_cast<float>(std::max(0.0, distance - size));
    view.resolve.depth_far_m = static_cast<float>(distance + size);
    // Where the device does not keep pace, what will be seen next is not known.
    const bool keeps_pace = drawn.displayed.milliseconds * clock.fps() * std::abs(clock.speed) < 1000;
    if (clock.playing && keeps_pace)
        for (int32_t i = 1; i <= 2; i++) view.next_s.push_back(clock.shown_after_s(i));
    if (looked_ && same_image(*looked_, view)) return;
    view.id = looked_ ? looked_->id + 1 : 1;
    looked_ = view;
    render_thread.request(std::move(view));
}

// This frame's event is answered by a view or a stage that was asked for since.
void Viewer::ask_latency(uint64_t view_before, uint64_t stage_before) {
    const uint64_t view = looked_ ? looked_->id : 0;
    if (came_s_ && drawn.displayed.view > 0 && (view != view_before || shown_document_ != stage_before))
        asked_.push_back({view, shown_document_, *came_s_});
}

// How long it took from an event to the end of the frame that shows the image which answers it. What waits for files
// that are read does not count.
void Viewer::note_latency() {
    if (!drawn.loading.empty() || !drawn.problem.empty()) asked_.clear();
    while (!asked_.empty() && asked_.front().view <= drawn.displayed.view &&
           asked_.front().stage <= drawn.displayed.stage) {
        latency_ms_ = 1000 * (seconds_since(begin_) - asked_.front().came_s);
        worst_latency_ms_ = std::max(worst_latency_ms_, latency_ms_);
        asked_.pop_front();
    }
}

const stage::Stage* Viewer::stage_of_document() const {
    if (!stage || !editor.is_open()) return nullptr;
    return stage->scene.nodes.size() == editor.node_count() ? stage.get() : nullptr;
}

void Viewer::begin_export(std::shared_ptr<Export> job) {
    exporting = std::move(job);
    export_begin_s = now_s;
    clock.pause();
    editor.freeze("an export goes on: cancel it to edit");
    render_thread.post_idle([job = exporting](editor::OnDevice& on_device) {
        const bool more = job->step(on_device);
        ui::Window::wake();
        return more;
    });
}

void Viewer::end_export() {
    const std::optional<Export::End> end = exporting ? exporting->end() : std::nullopt;
    if (!end) return;
    editor.freeze({});
    editor.notify(end->text, end->error);
    exporting.reset();
}

bool Viewer::image_is_sharp() const {
    return drawn.displayed.finished && looked_ && drawn.displayed.view == looked_->id &&
           drawn.displayed.stage == shown_document_;
}

void Viewer::go_to(const Eye& target) {
    flight_ = Flight{eye, target, now_s};
}

// Whatever else moved the eye since ends it.
void Viewer::go_along_path() {
    const bool moved = along_eye_ && eye != *along_eye_;
    if (!stage || !stage->settings.camera_path || moved) along_path = false;
    along_eye_.reset();
    if (along_path) eye = *(along_eye_ = eye_at(*stage->settings.camera_path, clock.shown_s(), *this));
}

void Viewer::take_keys() {
    escape = false;
    const bool typing = ImGui::GetIO().WantTextInput, asked = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
    for (const ui::KeyPress& press : window.presses()) {
        if (press.key == GLFW_KEY_ESCAPE) escape = true;
        if (typing || asked || holds_handle) continue;
        if (press.control) take_control_key(press);
        take_image_key(*this, press);
        if (press.control || press.alt) continue;
        if (press.key == GLFW_KEY_COMMA) clock.step(-1);
        if (press.key == GLFW_KEY_PERIOD) clock.step(1);
        if (press.repeat) continue;
        if (press.key == GLFW_KEY_SPACE) clock.play_or_pause();
        if (press.key == GLFW_KEY_HOME) clock.scrub(clock.in_s());
        if (press.key == GLFW_KEY_END) clock.scrub(clock.last_s());
        const bool beside_fields = ImGui::GetIO().MousePos.x < image_area.left + image_area.width;
        if (beside_fields && (press.key == GLFW_KEY_ENTER || press.key == GLFW_KEY_KP_ENTER))
            press.shift ? remove_key_near(*this) : add_key_here(*this);
        if (press.key == GLFW_KEY_TAB) panels.all = !panels.all;
        if (press.key == GLFW_KEY_F11) window.toggle_full_screen();
        if (press.key == GLFW_KEY_F12) press.shift ? screenshots.want_window() : screenshots.want_image();
    }
    if (!typing && !asked) take_node_keys(*this);
    if (!typing && window.typed().find(U'?') != std::u32string::npos) panels.help = !panels.help;
}

void Viewer::take_control_key(const ui::KeyPress& press) {
    switch (press.key) {
        case GLFW_KEY_Z:
            return press.shift ? editor.redo() : editor.undo();
        case GLFW_KEY_Y:
            return editor.redo();
        case GLFW_KEY_S:
            return press.shift ? files.save_as() : files.save();
        case GLFW_KEY_N:
            return files.new_stage();
        case GLFW_KEY_O:
            return files.ask_path("Open", {".gltf", ".glb", ".nvv", ".npz"}, false, "",
                                  [this](const std::filesystem::path& path) { files.open(path); });
        case GLFW_KEY_Q:
            return window.close();
        default:
            return;
    }
}

void Viewer::tell_report() {
    if (!report.on()) return;
    for (std::string& message : device.drain_validation_messages())
        if (validation_.size() < kMostMessages) validation_.push_back(std::move(message));
    report.place("picture", image_area.left, image_area.top, image_area.width, image_area.height);
    report.fact("open", editor.is_open() ? editor.file().path.string() : "");
    report.fact("modified", editor.modified());
    report.fact("ready", stage && drawn.stage_id == editor.id() && drawn.displayed.view > 0);
    report.fact("view", drawn.displayed.view);
    report.fact("finished", looked_ && !looked_->moving && image_is_sharp());
    report.fact("scale", drawn.displayed.scale);
    report.fact("picture_ms", drawn.displayed.milliseconds);
    report.fact("time_s", clock.time_s());
    report.fact("playing", clock.playing);
    report.fact("along_path", along_path);
    report.fact("latency_ms", latency_ms_);
    report.fact("worst_latency_ms", worst_latency_ms_);
    report.fact("frame_ms", frame_ms_);
    report.fact("worst_frame_ms", worst_frame_ms_);
    const ui::HandledInput handled = window.handled();
    report.fact("handled", {{"x", handled.x},
                            {"y", handled.y},
                            {"releases", handled.releases},
                            {"scrolls", handled.scrolls},
                            {"all", !window.has_more()}});
    report.fact("busy", jobs.under_way());
    report.fact("problem", drawn.problem);
    report.fact("validation", validation_);
    nlohmann::json selected = nullptr;
    if (editor.selected()) selected = *editor.selected();
    report.fact("selected", selected);
    nlohmann::json told = nlohmann::json::array();
    for (const editor::Notice& notice : notices_) told.push_back(notice.text);
    report.fact("notices", told);
    if (!report.end_frame()) redraw(1);
}

}  // namespace neuvv::viewer

#include "tools/viewer/viewer.h"

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "base/platform.h"
#include "tools/viewer/report_facts.h"
#include "tools/viewer/timeline/camera_path_view.h"
#include "tools/viewer/timeline/timeline_view.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/view_request.h"

namespace neuvv::viewer {

namespace {

constexpr double kIdleWait_s = 0.5, kPlayingWait_s = 1.0 / 30, kMovingWait_s = 1.0 / 60, kFrame_s = 1.0 / 60;
constexpr double kStillAfter_s = 0.12, kNotice_s = 6;
constexpr size_t kMaxMessages = 20, kMaxNotices = 4;
constexpr double kFirstPitch = -0.12;

double aspect_of(const Area& area) {
    return area.height > 0 ? area.width / area.height : 1;
}

// The eye with which a stage is first displayed: that of its first perspective camera, else from the front, a little
// above, with the leaves of all performers in view.
Eye initial_eye(const Context& context, const stage::EvaluatedStage& evaluated) {
    const stage::Stage& stage = *context.frame.stage;
    for (const stage::EvaluatedCamera& camera : evaluated.cameras)
        if (!camera.orthographic) return eye_of(camera, stage, evaluated);
    auto [low, high] = stage::performers_box(stage, evaluated);
    if (const auto leaves = box_of_performers(context, evaluated)) std::tie(low, high) = *leaves;
    Eye eye = seen_from(Eye{}, EyeSide::kFront);
    eye.pitch = kFirstPitch;
    return framed(eye, low, high, aspect_of(context.frame.image_area));
}

// What the view menu shows and hides, by the names under which preferences keep it.
std::array<std::pair<const char*, bool*>, 4> switches(ViewState& view) {
    return {{{"grid", &view.grid},
             {"axes", &view.axes},
             {"statistics", &view.panels.statistics},
             {"pass times", &view.panels.pass_times}}};
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

// Closes menus and combo boxes by Escape. Modal dialogs handle it themselves.
void close_popup_by_escape(const FrameInput& input) {
    const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
    if (!input.escape || open.empty()) return;
    const ImGuiWindow* window = open.back().Window;
    if (window && !(window->Flags & ImGuiWindowFlags_Modal)) ImGui::ClosePopupToLevel(open.Size - 1, true);
}

}  // namespace

Viewer::Viewer(const Options& options, const std::string& device)
    : preferences_(preferences_for(options, preferences_message_)),
      window_("NeuVV", preferences_.window),
      device_choice_(device),
      validation_(options.validate ? gpu::Validation::kOn : gpu::Validation::kOff),
      device_(std::in_place, device_choice_, validation_, window_.extensions()),
      screen_(std::in_place, *device_, window_,
              options.ui_scale.value_or(static_cast<float>(preferences_.ui_scale) * window_.content_scale())),
      report_(options.report),
      jobs_([this](const std::string& problem) { editor_.notify(problem, true); }, ui::Window::wake),
      render_thread_(*device_, ui::Window::wake),
      files_(context_, preferences_, exporter_,
             {[this] {
                  tools_.document_opened();
                  timeline_.key_drag.reset();
              },
              [this](std::set<std::filesystem::path> layers) { paint_.protect_layers(std::move(layers)); },
              [this](const std::string& verb, const std::filesystem::path& input) { verb_.ask(verb, input); },
              [this](const std::filesystem::path& motion) {
                  coaching_.address = motion.string();
                  coaching_.begin(context_);
              }}),
      screenshots_(options.screenshots),
      shader_watch_(context_.parts(), options.shaders),
      paint_(*device_),
      begin_(std::chrono::steady_clock::now()) {
    view_.mode = &tools_.first_mode();
    view_.image.max_scale = static_cast<float>(preferences_.preview.resolution);
    view_.image.samples = std::clamp(static_cast<int>(std::lround(std::sqrt(preferences_.preview.samples))), 1, 4);
    view_.image.far_levels = preferences_.preview.far_levels;
    if (const auto side = preferences_.panels.find("side"); side != preferences_.panels.end()) {
        view_.panels.all = side->second.open;
        view_.panels.side_width = static_cast<float>(side->second.width);
    }
    for (const auto& [name, on] : switches(view_))
        if (const auto kept = preferences_.panels.find(name); kept != preferences_.panels.end())
            *on = kept->second.open;
    for (size_t i = 0; i < std::size(kLayerNames); ++i)
        if (preferences_.layer == kLayerNames[i]) view_.image.show = static_cast<render::Show>(i);
    if (!preferences_message_.empty()) editor_.notify(preferences_message_, true);
    if (!options.trainee.empty()) coaching_.begin_with_stage(options.trainee);
    if (options.file.empty())
        files_.offer_recovery();
    else
        files_.open(options.file);
}

// Jobs and tasks of the render thread use the other members, so they must end first.
Viewer::~Viewer() {
    jobs_.stop();
    exporter_.cancel();
    render_thread_.stop();
}

double Viewer::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void Viewer::store_preferences() {
    const std::filesystem::path file = preferences_file();
    if (file.empty()) return;
    const ImageSettings& image = view_.image;
    preferences_.window = window_.geometry();
    preferences_.preview = {image.max_scale, static_cast<uint32_t>(image.samples * image.samples), image.far_levels};
    preferences_.layer = kLayerNames[static_cast<size_t>(image.show)];
    preferences_.panels["side"] = {view_.panels.all, view_.panels.side_width};
    for (const auto& [name, on] : switches(view_)) preferences_.panels[name].open = *on;
    save_preferences(file, preferences_);
}

void Viewer::run() {
    try {
        while (!window_.close_requested()) {
            try {
                round();
            } catch (const gpu::VulkanError& error) {
                if (!error.device_lost()) throw;
                recover_device(error.what());
            }
        }
    } catch (...) {
        jobs_.stop();
        files_.keep_unsaved_edits();
        throw;
    }
    store_preferences();
}

// Makes the device anew, and what the window and the render thread have on it. All else stays as it is; what was drawn
// is drawn again.
void Viewer::recover_device(std::string why) {
    const float scale = screen_->scale();
    const gpu::ShaderReplacements shaders = device_->shaders().replacements();
    render_thread_.release();
    paint_.free_surface();
    input_.rendered = {};
    for (bool is_there = false; !is_there;) {
        screen_.reset();
        device_.reset();
        losses_.note(why, seconds());
        try {
            device_.emplace(device_choice_, validation_, window_.extensions());
            screen_.emplace(*device_, window_, scale);
            is_there = true;
        } catch (const RuntimeFailure& failure) {
            why = failure.what();
        } catch (const InputError& failure) {  // while a device is reset, none has the name that the user chose
            why = failure.what();
        }
        if (!is_there) std::this_thread::sleep_for(std::chrono::seconds(1));
    }
    device_->shaders().set(shaders);
    screenshots_.request_again();
    render_thread_.restart();
    requests_.reload_document = true;
    if (view_request_) {
        ++view_request_->id;
        render_thread_.request(*view_request_);
    }
    editor_.notify("the device was lost, and has been made anew", true);
    context_.redraw();
}

void Viewer::round() {
    wait();
    read_input();
    frame();
    const bool displays = input_.rendered.displayed.view > 0;
    meter_.add_frame(seconds() - input_.now_s, displays);
    if (!input_.rendered.loading.empty() || !input_.rendered.problem.empty()) meter_.forget_requests();
    meter_.displayed({input_.rendered.displayed.view, input_.rendered.displayed.stage}, seconds());
    requests_.frames = std::max(0, requests_.frames - 1);
    if (!window_.close_requested() || may_close_) return;
    window_.keep_open();
    context_.redraw();
    const auto close = [this] {
        files_.when_saved_or_discarded([this] {
            may_close_ = true;
            window_.close();
        });
    };
    if (verb_.is_running()) return files_.ask_to_stop(verb_.form().title, close);
    close();
}

// Waits until there is something to draw. A new image of the render thread, or the result of a job, ends the wait at
// once. Anything else is drawn no earlier than kFrame_s after the previous frame, so that panels leave time for tracing
// where both use the same cores.
void Viewer::wait() {
    double seconds_left = kIdleWait_s;
    if (view_.clock.playing) seconds_left = std::min(kPlayingWait_s, view_.clock.until_next_s());
    if (in_motion() || coaching_.is_running()) seconds_left = kMovingWait_s;
    if (requests_.frames > 0 || window_.has_more()) seconds_left = 0;
    if (seconds_left > 0) window_.wait(seconds_left);
    for (double left; (left = input_.now_s + kFrame_s - seconds()) > 0;) {
        if (render_thread_.state().displayed.number != input_.rendered.displayed.number || jobs_.has_posted()) return;
        window_.wait(left);
    }
}

// The eye flies, or something moved less than kStillAfter_s ago.
bool Viewer::in_motion() const {
    return flight_ || requests_.eye || input_.now_s - requests_.last_motion_s < kStillAfter_s;
}

bool Viewer::image_is_sharp() const {
    const editor::DisplayedImage& displayed = input_.rendered.displayed;
    return displayed.finished && view_request_ && displayed.view == view_request_->id &&
           displayed.stage == requested_document_;
}

void Viewer::read_input() {
    const uint64_t displayed_before = input_.rendered.displayed.number;
    const bool event = window_.poll();
    const double now_s = seconds();
    input_.dt_s = now_s - input_.now_s;
    input_.now_s = now_s;
    input_.event_s.reset();
    if (event) input_.event_s = std::chrono::duration<double>(window_.came() - begin_).count();
    input_.presses = window_.presses();
    input_.typed = window_.typed();
    input_.escape = std::any_of(input_.presses.begin(), input_.presses.end(),
                                [](const ui::KeyPress& press) { return press.key == GLFW_KEY_ESCAPE; });
    const auto axis = [&](int plus, int minus) {
        return (window_.is_down(plus) ? 1.0 : 0.0) - (window_.is_down(minus) ? 1.0 : 0.0);
    };
    input_.flight_keys = {axis(GLFW_KEY_W, GLFW_KEY_S), axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
                          false, false};
    input_.rendered = render_thread_.state();
    meter_.count_image(input_.rendered.displayed.view, now_s);
    if (event) context_.redraw();
    if (input_.rendered.displayed.number != displayed_before) context_.redraw(1);
}

void Viewer::frame() {
    jobs_.run_posted();
    take_notices();
    receive_stage();
    const bool can_take_back = editor_.dragging() || editor_.history().next_undo();
    if (can_take_back && input_.rendered.unsound_id == editor_.id()) editor_.take_back(input_.rendered.problem);
    set_title();
    files_.tick();
    shader_watch_.tick(input_.now_s, !exporter_.job());
    exporter_.tick(context_);
    for (const std::filesystem::path& path : window_.dropped()) files_.open_or_add(path);
    apply_ui_scale();
    report_.begin_frame();
    screen_->begin();
    view_.clock.tick(input_.dt_s);  // before the keys: they may start the clock, which has not run since the last frame
    handle_keys();
    screenshots_.take(context_, *screen_, image_is_sharp());
    const FrameMeter::Ids before = requested();
    move_eye();
    coaching_.tick(context_);
    play_sound();
    draw_panels();
    if (editor_.dragging() && !ImGui::IsAnyItemActive() && !tools_.is_editing()) editor_.end_drag();
    request_document();
    request_view();
    meter_latency(before);
    write_report();
    const Area& area = input_.image_area;
    const VkRect2D image_area{{static_cast<int32_t>(area.left), static_cast<int32_t>(area.top)},
                              {static_cast<uint32_t>(area.width), static_cast<uint32_t>(area.height)}};
    if (!screen_->end({input_.rendered.displayed.image, input_.rendered.displayed.size, image_area})) context_.redraw();
    render_thread_.presented(input_.rendered.displayed.number);
}

// While nothing is open, errors stay: they say why nothing could be opened.
void Viewer::take_notices() {
    for (editor::Notice& notice : editor_.take_notices()) {
        notice.until_s = input_.now_s + kNotice_s;
        notices_.push_back(std::move(notice));
        context_.redraw();
    }
    std::erase_if(notices_, [&](const editor::Notice& notice) {
        return notice.until_s < input_.now_s && (editor_.is_open() || !notice.error);
    });
    if (notices_.size() > kMaxNotices)
        notices_.erase(notices_.begin(), notices_.end() - static_cast<std::ptrdiff_t>(kMaxNotices));
}

// Takes over the stage that the render thread has read.
void Viewer::receive_stage() {
    const std::shared_ptr<const stage::Stage> read = input_.rendered.stage;
    if (!read || read == input_.stage) return;
    const bool first = !input_.stage || input_.stage->file.path != read->file.path;
    input_.stage = read;
    editor_.stage_made(*read, input_.rendered.stage_id);
    view_.clock.set_stage(read->duration_s, read->fps);
    input_.evaluated = stage::stage_at(*read, view_.clock.displayed_s());
    if (first) view_.eye = initial_eye(context_, stage::stage_at(*read, 0));
}

void Viewer::set_title() {
    std::string title = "NeuVV";
    if (editor_.is_open()) title = fmt::format("{}{} – NeuVV", editor_.modified() ? "• " : "", files_.name());
    if (title == title_) return;
    title_ = title;
    window_.set_title(title);
}

void Viewer::apply_ui_scale() {
    if (requests_.ui_scale) {
        const float scale = *std::exchange(requests_.ui_scale, std::nullopt);
        preferences_.ui_scale =
            std::clamp(static_cast<double>(scale) / static_cast<double>(window_.content_scale()), 0.5, 4.0);
        screen_->set_scale(scale);
        context_.redraw();
    }
    input_.ui_scale = screen_->scale();
}

void Viewer::handle_keys() {
    const bool typing = ImGui::GetIO().WantTextInput, asked = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
    const bool free = !typing && !asked && !tools_.is_editing();
    input_.flight_keys.fast = ImGui::GetIO().KeyShift;
    input_.flight_keys.slow = ImGui::GetIO().KeyAlt;
    if (free)
        for (const ui::KeyPress& press : input_.presses) handle_key(press);
    if (free) handle_node_keys(context_, tree_);
    if (!typing && input_.typed.find(U'?') != std::u32string::npos) view_.panels.help = !view_.panels.help;
}

void Viewer::handle_key(const ui::KeyPress& press) {
    editor::StageClock& clock = view_.clock;
    if (press.control) handle_control_key(press);
    tools_.handle_key(context_, press);
    if (press.control || press.alt) return;
    if (press.key == GLFW_KEY_COMMA) clock.step(-1);
    if (press.key == GLFW_KEY_PERIOD) clock.step(1);
    if (press.repeat) return;
    if (press.key == GLFW_KEY_SPACE) clock.play_or_pause();
    if (press.key == GLFW_KEY_HOME) clock.scrub(clock.in_s());
    if (press.key == GLFW_KEY_END) clock.scrub(clock.last_s());
    const bool beside_fields = ImGui::GetIO().MousePos.x < input_.image_area.left + input_.image_area.width;
    if (beside_fields && (press.key == GLFW_KEY_ENTER || press.key == GLFW_KEY_KP_ENTER))
        press.shift ? remove_nearest_key(context_) : add_key_here(context_);
    if (press.key == GLFW_KEY_M) view_.sound = !view_.sound;
    if (press.key == GLFW_KEY_TAB) view_.panels.all = !view_.panels.all;
    if (press.key == GLFW_KEY_F11) window_.toggle_full_screen();
    if (press.key == GLFW_KEY_F12) press.shift ? screenshots_.request_window() : screenshots_.request_image();
}

void Viewer::play_sound() {
    const double speed = view_.clock.playing && view_.sound ? view_.clock.speed : 0;
    stage::EvaluatedStage now = input_.evaluated;
    now.time_s = view_.clock.time_s();  // the displayed time stands still from frame to frame
    for (stage::EvaluatedPerformer& performer : now.performers)
        performer.visible &= input_.stage && view_.hears(input_.stage->performers[performer.performer].name);
    sound_player_.follow(input_.stage, now, speed, glm::mat4(world_from_eye(view_.eye)));
    for (const std::string& problem : {sound_player_.take_problem(), waveforms_.take_problem()})
        if (!problem.empty()) editor_.notify(problem, true);
}

void Viewer::handle_control_key(const ui::KeyPress& press) {
    switch (press.key) {
        case GLFW_KEY_Z:
            return press.shift ? editor_.redo() : editor_.undo();
        case GLFW_KEY_Y:
            return editor_.redo();
        case GLFW_KEY_S:
            return press.shift ? files_.save_as() : files_.save();
        case GLFW_KEY_N:
            return files_.new_stage();
        case GLFW_KEY_O:
            return files_.ask_to_open();
        case GLFW_KEY_Q:
            return window_.close();
        default:
            return;
    }
}

// Moves the eye on its flight, or along the camera path. Any other motion of the eye ends the latter.
void Viewer::move_eye() {
    if (requests_.eye) flight_ = Flight{view_.eye, *std::exchange(requests_.eye, std::nullopt), input_.now_s};
    if (flight_) {
        const double flown_s = input_.now_s - flight_->begin_s;
        view_.eye = between(flight_->from, flight_->to, flown_s);
        if (flown_s > kEyeMove_s) flight_.reset();
        context_.mark_motion();
    }
    if (input_.stage) input_.evaluated = stage::stage_at(*input_.stage, view_.clock.displayed_s());
    const bool moved = path_eye_ && view_.eye != *path_eye_;
    if (!input_.stage || !input_.stage->settings.camera_path || moved) view_.along_path = false;
    path_eye_.reset();
    if (!view_.along_path) return;
    path_eye_ = eye_at(*input_.stage->settings.camera_path, view_.clock.displayed_s(), context_);
    view_.eye = *path_eye_;
}

// The layout: the image at the left, the stage and the properties at the right, the timeline below the image.
void Viewer::draw_panels() {
    PanelLayout& panels = view_.panels;
    close_popup_by_escape(input_);
    menu_bar(context_, {files_, window_, preferences_, tree_, verb_});
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float top = ImGui::GetFrameHeight();
    Area side, below;
    if (panels.all) {
        side.width = std::round(std::min(std::max(context_.ui(panels.side_width), context_.ui(180)), 0.5f * window.x));
        side.left = window.x - side.width;
        side.top = top;
        side.height = window.y - top;
        below.height = std::round(
            std::min(std::max(context_.ui(panels.timeline_height), context_.ui(80)), 0.5f * (window.y - top)));
        below.width = window.x - side.width;
        below.top = window.y - below.height;
    }
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    input_.image_area = {0, top, window.x - side.width, window.y - top - below.height};
    input_.camera = camera_of(view_.eye, std::max(1u, static_cast<uint32_t>(input_.image_area.width)),
                              std::max(1u, static_cast<uint32_t>(input_.image_area.height)));
    input_.pointer_in_image = !ImGui::GetIO().WantCaptureMouse && input_.image_area.contains(pointer.x, pointer.y);
    tools_.toolbar(context_);
    tools_.handle_pointer(context_);
    coaching_.draw(context_);
    if (panels.all) {
        const float tree = std::round(panels.tree_share * side.height);
        stage_panel(context_, {side.left, side.top, side.width, tree}, tree_);
        properties_panel(context_, {side.left, side.top + tree, side.width, side.height - tree}, properties_,
                         {tree_, paint_, files_, exporter_, coaching_});
        timeline_panel(context_, below, timeline_, waveforms_);
    }
    statistics_panel(context_, *device_, meter_);
    if (panels.help) help_panel(context_);
    about_panels(context_, *device_);
    verb_dialog(context_, verb_, files_);
    notices_panel(context_, notices_);
    files_.panel();
}

void Viewer::request_document() {
    if (std::exchange(requests_.reload_document, false)) requested_document_ = 0;
    if (!editor_.is_open() || editor_.id() == requested_document_) return;
    requested_document_ = editor_.id();
    render_thread_.show(std::make_shared<const edit::Document>(editor_.document()), requested_document_);
    if (editor_.dragging()) context_.mark_motion();
}

void Viewer::request_view() {
    const stage::Camera& camera = input_.camera;
    if (!input_.stage || camera.width < 2 || camera.height < 2) return;
    const bool moving = view_.clock.playing || in_motion() || editor_.dragging();
    editor::ViewRequest view = requested_view(input_, view_, moving);
    view.highlight = coaching_.session().highlight();
    if (view_request_ && is_same_image(*view_request_, view)) return;
    view.id = view_request_ ? view_request_->id + 1 : 1;
    view_request_ = view;
    render_thread_.request(std::move(view));
}

// The view and the document that this frame requested are the effect of its first event, or of the earlier event that
// FrameRequests names.
void Viewer::meter_latency(const FrameMeter::Ids& before) {
    std::optional<double> event_s = input_.event_s;
    if (const auto earlier_event_s = std::exchange(requests_.earlier_event_s, std::nullopt))
        event_s = std::min(event_s.value_or(*earlier_event_s), *earlier_event_s);
    if (event_s && input_.rendered.displayed.view > 0 && requested() != before) meter_.request(requested(), *event_s);
}

void Viewer::write_report() {
    if (!report_.enabled()) return;
    for (std::string& message : device_->drain_validation_messages())
        if (validation_messages_.size() < kMaxMessages) validation_messages_.push_back(std::move(message));
    const bool still = view_request_ && !view_request_->moving;
    report_facts(context_, {paint_, coaching_, meter_, window_, notices_, validation_messages_, verb_, title_,
                            still && image_is_sharp()});
    if (!report_.end_frame()) context_.redraw(1);
}

}  // namespace neuvv::viewer

// The viewer: what the window shows and what hands change, shared by all panels.
//
// A frame: poll → keys → clock → panels, which change the editor, the eye, the settings → what changed goes to the
// render_thread. A panel is a function of a Viewer in a file of its own; it draws with ImGui and does what it does
// through Editor::edit, so that everything can be undone.
#pragma once

#include <chrono>
#include <deque>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/job_queue.h"
#include "edit/operations.h"
#include "editor/clock.h"
#include "editor/editor.h"
#include "editor/render_thread.h"
#include "editor/shader_watch.h"
#include "stage/evaluated_stage.h"
#include "tools/viewer/export.h"
#include "tools/viewer/files.h"
#include "tools/viewer/panels/stage_rows.h"
#include "tools/viewer/report.h"
#include "tools/viewer/screen.h"
#include "tools/viewer/screenshot.h"
#include "tools/viewer/timeline/timeline_state.h"
#include "tools/viewer/tools/image_tools.h"
#include "tools/viewer/tools/navigation.h"
#include "tools/viewer/tools/paint_tool.h"

namespace neuvv::viewer {

// A part of the window, in pixels of its framebuffer.
struct Area {
    float left = 0, top = 0, width = 0, height = 0;
    bool holds(float x, float y) const { return x >= left && y >= top && x < left + width && y < top + height; }
};

// What the hand holds of the image while a button is down: decided where it went down.
enum class Hold { kNothing, kOrbit, kPan, kTurn };
struct Grip {
    Hold hold = Hold::kNothing;
    int button = 0;
    bool moved = false;  // a drag, no click any more
};

// What a click or a drag in the image does.
enum class Tool { kMove, kRotate, kScale, kPaint };

constexpr const char* kLayerNames[] = {"colour", "alpha", "depth", "leaf level", "cost per ray"};  // by Show

// How the image is drawn; nothing of it is saved with the stage.
struct ImageSettings {
    render::Show show = render::Show::kColour;
    float cost_max = 256;  // steps shown brightest
    bool own_background = false;
    glm::vec3 background{0.2f};  // sRGB, where it is the viewer's own
    float most_scale = 1;        // rays a pixel along each side while moving
    int samples = 2;             // when still
};

constexpr const char* kAlongPath = "along the camera path";

// What is exported, as chosen in the panel.
struct ExportChoice {
    size_t kind = 0;  // video, numbered images, one image
    media::ImageSize size{1920, 1080};
    std::string camera;  // of the stage, or kAlongPath; empty: the window's view
    size_t range = 0;    // the whole stage, the clock's range
    double fps = 0;      // 0: the stage's
    size_t samples = 1;  // rays along a pixel's side, less one
    bool transparent = false;
};

struct Panels {
    bool all = true;  // Tab
    bool speed = false, help = false;
    Tool seen_tool = Tool::kMove;                   // in the last frame
    float side_width = 320, timeline_height = 170;  // at scale 1
    float tree_share = 0.33f;                       // of the side's height
};

// The tree of nodes.
struct StageTree {
    uint64_t id = 0;  // of the document that the rows are of
    std::vector<StageRow> rows;
    std::set<std::string> closed;           // titles of rows whose lower ones are not seen
    std::optional<uint32_t> renaming;       // the node whose name is typed
    std::string typed;                      // so far
    bool begin_typing = false;              // in this frame
    std::optional<uint32_t> seen_selected;  // already scrolled to
};

// What fields show that the document does not say in these words.
struct PropertyFields {
    struct Angles {
        uint32_t node = 0;
        glm::dvec3 deg{0};
    } angles;  // as typed: others mean the same turn
    struct Time {
        std::optional<uint32_t> node;  // none: nothing is wrong
        uint64_t id = 0;               // of the document it was typed for
        std::string typed, error;
    } time;
    struct Text {
        unsigned id = 0;  // of ImGui; 0: none is typed
        std::string typed;
    } text;
    bool evenly = true;  // scale all axes alike
};

// Asked before a node is duplicated.
struct CopyQuestion {
    bool ask = false;
    uint32_t node = 0;
    uint64_t id = 0;  // of the document
    edit::CopySettings settings{3, edit::CopyPattern::kRow, 1.5, 90, {0, true}, 0};
};

class Viewer {
  public:
    struct Options {
        std::string file;                // empty: an empty window
        std::optional<float> ui_scale;   // of panels; none: as the monitor and the preferences say
        std::filesystem::path report;    // empty: none
        std::optional<VkExtent2D> size;  // of the window; none: as it was last
        bool validate = false;
        std::filesystem::path screenshots;  // their folder; empty: where the user's images are
        std::filesystem::path shaders;      // sources that are watched; empty: none
    };
    Viewer(const Options& options, const std::string& device);
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    ~Viewer();

    // Until the window is closed. Throws what ends the program.
    void run();

  private:
    std::string preferences_message_;

  public:
    // --- the parts
    Preferences preferences;
    ui::Window window;
    gpu::Device device;
    Screen screen;
    JobQueue jobs;
    editor::RenderThread render_thread;
    editor::Editor editor;
    Files files;
    Report report;
    Screenshots screenshots;
    editor::ShaderWatch shader_watch;
    editor::Parts parts() { return {editor, jobs, render_thread}; }

    // --- what hands change
    Eye eye;
    editor::StageClock clock;
    ImageSettings image;
    Panels panels;
    ExportChoice export_choice;
    Tool tool = Tool::kMove;
    PaintTool paint;
    bool snap = false, local_axes = false, grid = false;
    StageTree stage_tree;
    PropertyFields fields;
    TimelineState timeline;
    CopyQuestion copies;
    bool along_path = false, show_path = true;  // the eye goes along the stage's camera path; it is drawn

    // --- this frame
    double now_s = 0, dt_s = 0;                 // of the window's clock
    editor::RenderThreadState drawn;            // as of the frame's beginning
    std::shared_ptr<const stage::Stage> stage;  // drawn.stage; null: none yet
    stage::EvaluatedStage evaluated;            // of it, as the clock shows it
    Area image_area;                            // where the image is, panels aside
    stage::Camera camera;                       // that it is seen by
    bool pointer_in_image = false;              // and over no panel, handle or popup
    bool escape = false;                        // was pressed
    std::vector<HandleShape> shapes;            // handles in the image, to be drawn over it, in its pixels
    std::optional<HeldGizmo> gizmo;             // while one is held
    std::optional<HeldLight> held_light;
    Grip grip;
    bool holds_handle = false;  // one in the image, which drags the editor's document
    float ui(float pixels) const { return pixels * screen.scale(); }  // at scale 1 → of the framebuffer

    // Something moves in the image just now: draw it soon rather than sharp.
    void moves() { last_move_s_ = now_s; }
    // Draw some more frames of the window, though no event came.
    void redraw(int frames = 3) { frames_left_ = std::max(frames_left_, frames); }
    // It shows what is looked at, and will not be drawn better as things stand.
    bool image_is_sharp() const;
    // Moves the eye there, smoothly.
    void go_to(const Eye& target);
    // The stage that is drawn, where its nodes have the document's numbers: it may be some edits behind.
    const stage::Stage* stage_of_document() const;

    // Letters of another size, from the next frame on.
    std::optional<float> wanted_scale;

    // One at a time; meanwhile nothing is edited.
    void begin_export(std::shared_ptr<Export> job);
    std::shared_ptr<Export> exporting;  // null: none
    double export_begin_s = 0;

    // Files that the stage plays are others now.
    void show_again() { shown_document_ = 0; }

    double images_per_second() const { return images_per_second_; }
    double latency_ms() const { return latency_ms_; }
    // This frame's event; and that what this frame changes answers one that came earlier.
    std::optional<double> came_s() const { return came_s_; }
    void answers(double came_s) { came_s_ = std::min(came_s_.value_or(came_s), came_s); }
    const std::vector<editor::Notice>& notices() const { return notices_; }

  private:
    void wait();
    void frame();
    void take_keys();
    void end_export();
    void take_control_key(const ui::KeyPress& press);
    void keep_preferences();
    void name_window();
    void go_along_path();
    void place_panels();
    void look();
    void tell_report();
    void ask_latency(uint64_t view_before, uint64_t stage_before);
    void note_latency();
    void count_images();
    bool something_goes_on() const;

    std::vector<editor::Notice> notices_;
    std::chrono::steady_clock::time_point begin_;
    double last_move_s_ = -1e9;
    int frames_left_ = 3;
    std::optional<editor::ViewRequest> looked_;
    uint64_t shown_document_ = 0, looked_stage_ = 0;
    // Views and stages that answer an event, which came then.
    struct Asked {
        uint64_t view = 0, stage = 0;
        double came_s = 0;
    };
    std::deque<Asked> asked_;
    std::optional<double> came_s_;  // of this frame's first event
    double latency_ms_ = 0, worst_latency_ms_ = 0;
    double frame_ms_ = 0, worst_frame_ms_ = 0;  // of the window's thread
    std::deque<double> shown_s_;                // when images came
    uint64_t counted_view_ = 0;
    double images_per_second_ = 0;
    struct Flight {
        Eye from, to;
        double begin_s = 0;
    };
    std::optional<Flight> flight_;
    std::string title_;
    bool may_close_ = false;
    std::optional<Eye> along_eye_;  // where the camera path had put the eye
    std::vector<std::string> validation_;
};

}  // namespace neuvv::viewer

// Painting in the image: brush, stamp and box under the pointer, and what of it is under way. paint_panel.cpp is its
// panel.
//
//     pointer ─► waiting pixels ─► PaintSession on the render thread ─► layer ─► Editor::drag ─► image
//                      ▲                                                  │
//                      └────────── the next ones, when it is back ────────┘
#pragma once

#include <filesystem>
#include <map>
#include <set>

#include "edit/paint_layers.h"
#include "editor/paint_session.h"

namespace neuvv::viewer {

class Viewer;
struct Area;

// What hands choose.
struct PaintChoice {
    enum class Tool { kColour, kErase, kShift, kRestore, kStamp } tool = Tool::kColour;
    bool in_box = false;  // all that is in the box at once, instead of what a brush touches
    double radius_m = 0.05, hardness = 0.7, opacity = 1;
    glm::dvec3 colour{0.6, 0.03, 0.05};  // linear
    double hue_degrees = 120, saturation = 1;
    enum class Frames { kThis, kRange, kAll } frames = Frames::kThis;
    int first = 0, last = 0;  // of kRange
    edit::Follow follow = edit::Follow::kRun;
    bool every_frame = false;            // of the stamp: onto each frame as it is then
    glm::dvec3 box_low{0}, box_high{0};  // performer's space, metres; equal: not chosen yet
    std::string image;                   // the stamp's file
    double stamp_share = 0.25;           // of the image's height that the stamp is high
    std::filesystem::path layer;         // that is painted; one that is not worn: the uppermost
};
constexpr double kLeastRadius_m = 0.002, kMostRadius_m = 1;
constexpr double kLeastStamp = 0.02, kMostStamp = 2;

// The performer that is painted, as the image shows it.
struct PaintedPerformer {
    uint32_t node = 0;
    std::string name;
    std::filesystem::path clip;  // absolute
    uint32_t frames = 1;
    float frame = 0;
    glm::dmat4 world_from_performer{1};
    bool seen = true;
    std::vector<edit::ListedLayer> layers;
};

// What of the mouse belongs to painting in this frame.
struct PaintHands {
    bool left = false, all = false, wheel = false;
};

class PaintTool {
  public:
    explicit PaintTool(const gpu::Device& device) : surface_(std::make_shared<editor::PaintSurface>(device)) {}

    PaintChoice choice;

    // Each frame, before the eye moves: pointer and keys in the image, its marks over it.
    PaintHands in_image(Viewer& viewer);
    // Reads what painting needs, where it is not there yet. True: it is.
    bool prepare(Viewer& viewer);

    // The selected performer, else the only one; nothing where there is none.
    static std::optional<PaintedPerformer> performer(const Viewer& viewer);
    // The painted layer, of performer.layers; its size: one that is to be made.
    size_t painted_layer(const PaintedPerformer& performer) const;
    // Of `frame` and the choice.
    edit::EditFrames frames_of(const PaintedPerformer& performer) const;

    // Layers whose files another stage wears, too: they stay as they are, and what is painted is a copy. None: so far.
    void leave_alone(std::set<std::filesystem::path> layers) { others_ = std::move(layers); }

    // For the panel.
    void paint_in_box(Viewer& viewer);
    void fit_box(const Viewer& viewer);  // around the performer's leaves
    void add_layer(Viewer& viewer);
    void load_image(Viewer& viewer);
    bool stamp_loaded() const { return stamp_ && stamp_path_ == choice.image; }
    bool busy() const { return stroke_ || task_runs_; }

  private:
    struct Active;
    struct Hover {
        bool under_way = false;
        glm::dvec2 pixel{-1e9};
        stage::Camera camera;
        float frame = -1;
        std::optional<glm::dvec3> world;
        double depth_m = 2;  // the last that was known
    };
    editor::PaintOperation operation_of(const PaintedPerformer& performer, bool inverted) const;
    editor::PaintSubject subject_of(const Viewer& viewer, const PaintedPerformer& performer,
                                    bool without_painted) const;
    std::shared_ptr<const voctree::EditLayer> layer_at(const Viewer& viewer, const std::filesystem::path& path) const;
    // The layer to be painted, opened in the editor; null with a notice where it cannot be.
    std::shared_ptr<const voctree::EditLayer> open_target(Viewer& viewer, const PaintedPerformer& performer,
                                                          std::filesystem::path& path);
    void take_keys(Viewer& viewer);
    void begin_stroke(Viewer& viewer, const PaintedPerformer& performer);
    void go_on(Viewer& viewer);
    void took(Viewer& viewer, const std::shared_ptr<Active>& active, std::shared_ptr<const voctree::EditLayer> layer);
    void look_under(Viewer& viewer, const PaintedPerformer& performer);
    void take_colour(Viewer& viewer);
    void project_stamp(Viewer& viewer, const PaintedPerformer& performer);
    std::string put_layer(edit::Document& document, uint32_t node, const std::filesystem::path& path,
                          const std::shared_ptr<const voctree::EditLayer>& layer, const std::string& what) const;
    void begin_task(const Viewer& viewer);
    // The end of what was begun with `before`.
    void put(Viewer& viewer, const PaintedPerformer& performer, const std::filesystem::path& path,
             const std::shared_ptr<const voctree::EditLayer>& before,
             const std::shared_ptr<const voctree::EditLayer>& layer, const std::string& what);
    bool drag_box(Viewer& viewer, const PaintedPerformer& performer);
    // Of the window.
    Area stamp_area(const Viewer& viewer) const;
    void draw_brush(const Viewer& viewer, const PaintedPerformer& performer) const;
    void draw_stamp(Viewer& viewer) const;

    std::shared_ptr<editor::PaintSurface> surface_;  // used on the render thread only
    // As read, of one clip and the layers that its performers show.
    std::filesystem::path clip_path_;
    bool reading_ = false;
    uint64_t failed_ = 0;  // the document for which reading did not do
    std::shared_ptr<const editor::PaintClip> clip_;
    std::map<std::filesystem::path, std::shared_ptr<const voctree::EditLayer>> read_;
    Hover hover_;
    std::shared_ptr<Active> stroke_;
    std::set<std::filesystem::path> others_;
    // A layer that is to become the performer's own, and the one that it shares with others.
    std::pair<std::filesystem::path, std::filesystem::path> own_;
    bool task_runs_ = false;                     // in a box, or a projection
    std::pair<uint64_t, size_t> task_began_on_;  // the document, and how many nodes it had: else numbers mean others
    std::string stamp_path_;
    std::shared_ptr<const media::Image> stamp_, stamp_preview_;
    struct BoxDrag {
        int axis = 0;
        bool high = false;
        double grabbed = 0, s = 0;  // the side's place, and that of the pointer beside it
    };
    std::optional<BoxDrag> box_drag_;
};

}  // namespace neuvv::viewer

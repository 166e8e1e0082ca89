// The tool that paints in the image: with a brush, with a stamp (an image that is projected), or all leaves in a box.
// panels/paint_panel.cpp is its panel.
//
//     pointer ─► waiting pixels ─► PaintSession on the render thread ─► layer ─► Editor::drag ─► image
//                      ▲                                                  │
//                      └──── the next pixels, once the layer is back ─────┘
#pragma once

#include <filesystem>
#include <map>
#include <set>

#include "edit/paint_layers.h"
#include "editor/paint/paint_session.h"
#include "editor/paint/paint_spread.h"
#include "tools/viewer/tools/tool.h"

namespace neuvv::viewer {

// What the user has set.
struct PaintSettings {
    enum class Tool { kColour, kErase, kShift, kRestore, kStamp } tool = Tool::kColour;
    bool in_box = false;  // paints all leaves in the box at once, instead of those that the brush touches
    double radius_m = 0.05, hardness = 0.7, opacity = 1;
    glm::dvec3 colour{0.6, 0.03, 0.05};  // linear
    double hue_degrees = 120, saturation = 1;
    enum class Frames { kThis, kRange, kAll } frames = Frames::kThis;
    int first = 0, last = 0;  // frames of the clip; of kRange
    edit::Follow follow = edit::Follow::kRun;
    bool every_frame = false;            // projects the stamp onto each frame's own surface
    glm::dvec3 box_low{0}, box_high{0};  // corners, performer's space, metres; equal: not set yet
    std::string image;                   // the file of the stamp
    double stamp_share = 0.25;           // the stamp's height, as a share of the height of the image
    std::filesystem::path layer;         // the painted layer; where the performer does not have it: the uppermost
};
constexpr double kMinRadius_m = 0.002, kMaxRadius_m = 1;
constexpr double kMinStamp = 0.02, kMaxStamp = 2;  // of stamp_share

// The performer that is painted, at the displayed time.
struct PaintedPerformer {
    uint32_t node = 0;
    std::string name;
    uint32_t frames = 1;       // of the clip
    float frame = 0;           // clip time
    editor::PaintPlace place;  // the segment that is seen
    glm::dmat4 world_from_performer{1};
    bool visible = true;
    std::vector<edit::ListedLayer> layers;
};

class PaintTool : public Tool {
  public:
    explicit PaintTool(const gpu::Device& device) : surface_(std::make_shared<editor::PaintSurface>(device)) {}

    static const ToolMode kMode;
    // Whether painting is the current mode.
    static bool is_current(const Context& context) { return context.view.mode == &kMode; }
    std::span<const ToolMode> modes() const override { return {&kMode, 1}; }
    void handle_key(Context& context, const ui::KeyPress& press) override;
    void handle_pointer(Context& context, PointerUse& use) override;
    bool captures_pointer() const override { return stroke_ || box_drag_; }
    bool is_editing() const override { return stroke_ != nullptr; }
    void document_opened() override { protect_layers({}); }
    // Frees what painting has on the device. The render thread must not run.
    void free_surface() { surface_->clear(); }

    PaintSettings settings;

    // Whether the clip and the layers that painting needs have been read. Starts a job that reads them where they have
    // not.
    bool prepare(Context& context);

    // The selected performer; else the only performer of the stage; else nullopt.
    static std::optional<PaintedPerformer> performer(const Context& context);
    // The index of the painted layer in performer.layers; 0 where there are no layers yet.
    size_t painted_layer(const PaintedPerformer& performer) const;
    // The frames of the clip that an edit applies to, by the settings.
    edit::EditFrames frames_of(const PaintedPerformer& performer) const;

    // Replaces the set of protected layers: another stage uses their files, too, so that a copy is painted instead.
    void protect_layers(std::set<std::filesystem::path> layers) { protected_layers_ = std::move(layers); }

    // For the panel.
    void paint_in_box(Context& context);
    void fit_box(const Context& context);  // sets the box around the performer's leaves
    void add_layer(Context& context);
    void load_image(Context& context);
    bool stamp_loaded() const { return stamp_ && stamp_path_ == settings.image; }
    bool busy() const { return stroke_ || task_runs_; }

    // For reports: whether a stroke can begin, and the depth of the surface under the pointer; nullopt: there is none.
    bool ready() const { return ready_; }
    std::optional<double> hover_depth_m() const { return hover_.world ? std::optional(hover_.depth_m) : std::nullopt; }

  private:
    struct Stroke;
    struct Hover {
        bool under_way = false;  // the render thread is looking for the surface
        glm::dvec2 pixel{-1e9};  // of the last request, as camera and frame
        stage::Camera camera;
        float frame = -1;
        std::optional<glm::dvec3> world;  // the point of the surface; nullopt: none
        double depth_m = 2;               // of the last known point
    };
    editor::PaintOperation operation_of(const PaintedPerformer& performer, bool inverted) const;
    editor::PaintSubject subject_of(const Context& context, const PaintedPerformer& performer,
                                    bool without_painted) const;
    editor::Layer layer_at(const Context& context, const std::filesystem::path& file) const;
    // The layer that is painted, and its file of the segment that is seen.
    struct Target {
        std::filesystem::path path, file;
        editor::Layer before;
    };
    // Opens the layer to be painted in the editor. Returns nullopt, and notifies the user, where it cannot be painted.
    std::optional<Target> open_target(Context& context, const PaintedPerformer& performer);
    Target new_target(const Context& context, const PaintedPerformer& performer) const;
    void set_radius_by_keys(const Context& context);
    void click_or_hover(Context& context, const PaintedPerformer& performer, PointerUse& use);
    void begin_stroke(Context& context, const PaintedPerformer& performer);
    void continue_stroke(Context& context);
    void apply_result(Context& context, const std::shared_ptr<Stroke>& active,
                      std::shared_ptr<const voctree::EditLayer> layer);
    void update_hover(Context& context, const PaintedPerformer& performer);
    void take_colour(Context& context);
    void project_stamp(Context& context, const PaintedPerformer& performer);
    std::string write_layer(edit::Document& document, uint32_t node, const Target& target, const editor::Layer& layer,
                            const std::string& what) const;
    void begin_task(const Context& context);
    editor::PaintSpreads& spreads(Context& context);
    // Ends the task that began with the target as it was before: writes its result `layer` into the document, unless
    // the document or the layer has changed meanwhile. Then other segments are painted, where `spread` says so.
    void write_result(Context& context, const PaintedPerformer& performer, const Target& target,
                      const editor::Layer& layer, const std::string& what, std::optional<editor::SpreadPaint> spread);
    // Draws the box and drags its handles. `pointer_used`: another tool uses the pointer. Returns whether this one
    // does.
    bool drag_box(Context& context, const PaintedPerformer& performer, bool pointer_used);
    // The area of the window that the stamp covers.
    Area stamp_area(const Context& context) const;
    void draw_brush(const Context& context, const PaintedPerformer& performer) const;
    void draw_stamp(Context& context) const;

    std::shared_ptr<editor::PaintSurface> surface_;  // used on the render thread only
    // What was read: one clip, or a segment, and files of layers of its performers.
    std::filesystem::path clip_file_;
    bool reading_ = false;
    std::pair<uint64_t, std::filesystem::path> failed_;  // the document's id, and the clip's file that was not read
    std::shared_ptr<const editor::PaintClip> clip_;
    voctree::PaintLayers read_;
    bool ready_ = false;
    Hover hover_;
    std::shared_ptr<Stroke> stroke_;
    std::set<std::filesystem::path> protected_layers_;
    // The copy that the performer gets for itself, and the shared layer that this copy replaces.
    std::pair<std::filesystem::path, std::filesystem::path> unshared_;
    std::optional<editor::PaintSpreads> spreads_;  // from the first one on
    bool task_runs_ = false;                       // painting in a box, or projecting
    // When the task began: Editor::open_count() and node_count(). Where they change, node numbers mean other nodes.
    std::pair<uint64_t, size_t> task_document_;
    std::string stamp_path_;
    std::shared_ptr<const media::Image> stamp_, stamp_preview_;
    struct BoxDrag {
        int axis = 0;
        bool high = false;
        double grabbed = 0, s = 0;  // coordinate of the side, and of the pointer along the axis from it, when grabbed
    };
    std::optional<BoxDrag> box_drag_;
};

}  // namespace neuvv::viewer

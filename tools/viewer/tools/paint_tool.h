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
#include "tools/viewer/tools/tool.h"

namespace neuvv::viewer {

// What hands choose.
struct PaintSettings {
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
constexpr double kMinRadius_m = 0.002, kMaxRadius_m = 1;
constexpr double kMinStamp = 0.02, kMaxStamp = 2;

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

class PaintTool : public Tool {
  public:
    explicit PaintTool(const gpu::Device& device) : surface_(std::make_shared<editor::PaintSurface>(device)) {}

    static const ToolMode kMode;
    // Whether the pointer paints.
    static bool is_current(const Context& context) { return context.view.mode == &kMode; }
    std::span<const ToolMode> modes() const override { return {&kMode, 1}; }
    void key(Context& context, const ui::KeyPress& press) override;
    void pointer(Context& context, PointerUse& use) override;
    bool captures_pointer() const override { return stroke_ || box_drag_; }
    bool is_editing() const override { return stroke_ != nullptr; }
    void document_opened() override { protect_layers({}); }

    PaintSettings settings;

    // Reads what painting needs, where it is not there yet. True: it is.
    bool prepare(Context& context);

    // The selected performer, else the only one; nothing where there is none.
    static std::optional<PaintedPerformer> performer(const Context& context);
    // The painted layer, of performer.layers; its size: one that is to be made.
    size_t painted_layer(const PaintedPerformer& performer) const;
    // Of `frame` and the settings.
    edit::EditFrames frames_of(const PaintedPerformer& performer) const;

    // Layers whose files another stage wears, too: they stay as they are, and what is painted is a copy. None: so far.
    void protect_layers(std::set<std::filesystem::path> layers) { protected_layers_ = std::move(layers); }

    // For the panel.
    void paint_in_box(Context& context);
    void fit_box(const Context& context);  // around the performer's leaves
    void add_layer(Context& context);
    void load_image(Context& context);
    bool stamp_loaded() const { return stamp_ && stamp_path_ == settings.image; }
    bool busy() const { return stroke_ || task_runs_; }

    // For reports: whether a stroke can begin, and how far away the surface under the pointer is, where there is one.
    bool ready() const { return ready_; }
    std::optional<double> hover_depth_m() const { return hover_.world ? std::optional(hover_.depth_m) : std::nullopt; }

  private:
    struct Stroke;
    struct Hover {
        bool under_way = false;
        glm::dvec2 pixel{-1e9};
        stage::Camera camera;
        float frame = -1;
        std::optional<glm::dvec3> world;
        double depth_m = 2;  // the last that was known
    };
    editor::PaintOperation operation_of(const PaintedPerformer& performer, bool inverted) const;
    editor::PaintSubject subject_of(const Context& context, const PaintedPerformer& performer,
                                    bool without_painted) const;
    std::shared_ptr<const voctree::EditLayer> layer_at(const Context& context, const std::filesystem::path& path) const;
    // The layer to be painted, opened in the editor; null with a notice where it cannot be.
    std::shared_ptr<const voctree::EditLayer> open_target(Context& context, const PaintedPerformer& performer,
                                                          std::filesystem::path& path);
    void set_radius_by_keys(const Context& context);
    void click_or_hover(Context& context, const PaintedPerformer& performer, PointerUse& use);
    void begin_stroke(Context& context, const PaintedPerformer& performer);
    void continue_stroke(Context& context);
    void apply_result(Context& context, const std::shared_ptr<Stroke>& active,
                      std::shared_ptr<const voctree::EditLayer> layer);
    void update_hover(Context& context, const PaintedPerformer& performer);
    void take_colour(Context& context);
    void project_stamp(Context& context, const PaintedPerformer& performer);
    std::string write_layer(edit::Document& document, uint32_t node, const std::filesystem::path& path,
                            const std::shared_ptr<const voctree::EditLayer>& layer, const std::string& what) const;
    void begin_task(const Context& context);
    // The end of what was begun with `before`.
    void write_result(Context& context, const PaintedPerformer& performer, const std::filesystem::path& path,
                      const std::shared_ptr<const voctree::EditLayer>& before,
                      const std::shared_ptr<const voctree::EditLayer>& layer, const std::string& what);
    // `pointer_used`: another tool uses it. True: this one does.
    bool drag_box(Context& context, const PaintedPerformer& performer, bool pointer_used);
    // Of the window.
    Area stamp_area(const Context& context) const;
    void draw_brush(const Context& context, const PaintedPerformer& performer) const;
    void draw_stamp(Context& context) const;

    std::shared_ptr<editor::PaintSurface> surface_;  // used on the render thread only
    // As read, of one clip and the layers that its performers show.
    std::filesystem::path clip_path_;
    bool reading_ = false;
    uint64_t failed_ = 0;  // the document for which reading did not do
    std::shared_ptr<const editor::PaintClip> clip_;
    std::map<std::filesystem::path, std::shared_ptr<const voctree::EditLayer>> read_;
    bool ready_ = false;
    Hover hover_;
    std::shared_ptr<Stroke> stroke_;
    std::set<std::filesystem::path> protected_layers_;
    // A layer that is to become the performer's own, and the one that it shares with others.
    std::pair<std::filesystem::path, std::filesystem::path> own_;
    bool task_runs_ = false;                     // in a box, or a projection
    std::pair<uint64_t, size_t> task_document_;  // the document, and how many nodes it had: else numbers mean others
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

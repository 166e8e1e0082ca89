// The tool with the handles of the selected node, which move, rotate and scale it.
#include <GLFW/glfw3.h>

#include "edit/operations.h"
#include "tools/ui/icons.h"
#include "tools/viewer/tools/gizmo.h"
#include "tools/viewer/tools/handle_drag.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/tools.h"

namespace neuvv::viewer {

namespace {

constexpr ToolMode kModes[] = {{"tool/move", ICON_MOVE, "Move (1)", GLFW_KEY_1},
                               {"tool/rotate", ICON_ROTATE, "Rotate (2)", GLFW_KEY_2},
                               {"tool/scale", ICON_SCALE, "Scale (3)", GLFW_KEY_3}};
constexpr GizmoMode kGizmoModes[] = {GizmoMode::kMove, GizmoMode::kRotate, GizmoMode::kScale};
constexpr float kGizmo_px = 90;  // at scale 1

// The gizmo of the selected node; nullopt: the current mode belongs to another tool, or no node that can be moved is
// selected.
std::optional<Gizmo> gizmo_of_selected(const Context& context) {
    const auto mode = std::find_if(std::begin(kModes), std::end(kModes),
                                   [&](const ToolMode& each) { return context.view.mode == &each; });
    const stage::Stage* stage = context.stage_of_document();
    const std::optional<uint32_t> node = context.editor.selected();
    if (mode == std::end(kModes) || !stage || !node || edit::is_locked(context.editor.file(), *node))
        return std::nullopt;
    if (*node >= stage->scene.nodes.size() || !stage->scene.nodes[*node].in_scene) return std::nullopt;
    return Gizmo{context.frame.camera, context.frame.evaluated.pose.world_from_node[*node],
                 kGizmoModes[mode - std::begin(kModes)],
                 context.view.local_axes ? GizmoAxes::kLocal : GizmoAxes::kWorld, context.ui(kGizmo_px)};
}

// Reports the rectangle around each handle.
void report_handles(const Context& context, std::span<const HandleShape> shapes) {
    constexpr const char* kNames[] = {"", "x", "y", "z", "yz", "zx", "xy", "centre"};
    for (const HandleShape& shape : shapes) {
        if (shape.handle == 0 || shape.count == 0) continue;
        glm::dvec2 low(shape.points[0]), high = low;
        for (uint32_t i = 1; i < shape.count; i++) {
            low = glm::min(low, glm::dvec2(shape.points[i]));
            high = glm::max(high, glm::dvec2(shape.points[i]));
        }
        const glm::vec2 at(low), size(high - low);
        context.report.area(std::string("gizmo/") + kNames[shape.handle], context.frame.image_area.left + at.x,
                            context.frame.image_area.top + at.y, size.x, size.y);
    }
}

class GizmoTool : public Tool {
  public:
    std::span<const ToolMode> modes() const override { return kModes; }
    bool captures_pointer() const override { return drag_.has_value(); }
    bool is_editing() const override { return drag_.has_value(); }
    void document_opened() override { drag_.reset(); }
    void overlay(Context& context) override { draw_handles(context, shapes_, hot_); }

    void handle_pointer(Context& context, PointerUse& use) override {
        shapes_.clear();
        if (drag_) {
            use.left = true;
            return drag_goes_on(context) ? drag(context) : drag_.reset();
        }
        const std::optional<Gizmo> gizmo = gizmo_of_selected(context);
        if (!gizmo) return;
        const bool free = context.frame.pointer_in_image && !use.left && !use.all;
        const GizmoHandle handle = free ? gizmo_handle_at(*gizmo, pointer_of(context)) : GizmoHandle::kNone;
        show(*gizmo, handle);
        report_handles(context, shapes_);
        if (handle == GizmoHandle::kNone) return;
        use.left = true;
        const uint32_t node = *context.editor.selected();
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Left))
            drag_ = {*gizmo, handle, pointer_of(context), node, world_from_parent(context, node)};
    }

  private:
    void show(const Gizmo& gizmo, GizmoHandle hot) {
        shapes_ = gizmo_shapes(gizmo);
        hot_ = static_cast<int>(hot);
    }

    void drag(Context& context) {
        const bool snap = context.view.snap != ImGui::GetIO().KeyCtrl;
        Gizmo moved = drag_->grabbed;
        moved.world_from_node = dragged(drag_->grabbed, drag_->handle, drag_->from, pointer_of(context), snap);
        const auto local = parent_from_node(drag_->world_from_parent, moved.world_from_node);
        if (!local) return;
        show(moved, drag_->handle);
        edit::Placement placement;
        placement.to = *local;
        context.editor.drag(
            [&](edit::Document& document) { return edit::place_node(document.file, drag_->node, placement); });
    }

    std::optional<HandleDrag<Gizmo, GizmoHandle>> drag_;
    std::vector<HandleShape> shapes_;
    int hot_ = 0;
};

}  // namespace

std::unique_ptr<Tool> make_gizmo_tool() {
    return std::make_unique<GizmoTool>();
}

}  // namespace neuvv::viewer

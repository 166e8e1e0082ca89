// The tool with the handles of the selected node, which move, rotate and scale it.
#include <GLFW/glfw3.h>

#include "edit/operations.h"
#include "tools/ui/icons.h"
#include "tools/viewer/tools/gizmo.h"
#include "tools/viewer/tools/handle_tool.h"
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
std::optional<Gizmo> node_gizmo_in(const Context& context) {
    const auto mode = std::find_if(std::begin(kModes), std::end(kModes),
                                   [&](const ToolMode& each) { return context.view.mode == &each; });
    const stage::Stage* stage = context.stage_of_document();
    const std::optional<uint32_t> node = context.editor.selected();
    if (mode == std::end(kModes) || !stage || !node || edit::is_locked(context.editor.file(), *node))
        return std::nullopt;
    if (*node >= stage->scene.nodes.size() || !stage->scene.nodes[*node].in_scene) return std::nullopt;
    // Below a flat parent no transform of the node can follow a drag.
    if (!parent_from_node(world_from_parent(context, *node), glm::dmat4(1))) return std::nullopt;
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
        for (uint32_t i = 1; i < shape.count; ++i) {
            low = glm::min(low, glm::dvec2(shape.points[i]));
            high = glm::max(high, glm::dvec2(shape.points[i]));
        }
        const glm::vec2 at(low), size(high - low);
        context.report.area(std::string("gizmo/") + kNames[shape.handle], context.frame.image_area.left + at.x,
                            context.frame.image_area.top + at.y, size.x, size.y);
    }
}

class GizmoTool : public HandleTool<Gizmo, GizmoHandle> {
  public:
    std::span<const ToolMode> modes() const override { return kModes; }

  protected:
    std::optional<Gizmo> gizmo_of_selected(const Context& context) const override { return node_gizmo_in(context); }
    std::vector<HandleShape> shapes_of(const Gizmo& gizmo) const override { return gizmo_shapes(gizmo); }
    GizmoHandle handle_at(const Gizmo& gizmo, glm::dvec2 pointer) const override {
        return gizmo_handle_at(gizmo, pointer);
    }
    Gizmo moved(const Drag& drag, glm::dvec2 pointer, bool snap) const override {
        Gizmo gizmo = drag.grabbed;
        gizmo.world_from_node = dragged(gizmo, drag.handle, drag.from, pointer, snap);
        return gizmo;
    }
    std::string apply(stage::StageFile& file, const Drag& drag, const Gizmo& gizmo) const override {
        edit::Placement placement;
        placement.to = parent_from_node(drag.parent, gizmo.world_from_node);
        return edit::place_node(file, drag.node, placement);
    }
    void report_shapes(const Context& context, std::span<const HandleShape> shapes) const override {
        report_handles(context, shapes);
    }
};

}  // namespace

std::unique_ptr<Tool> make_gizmo_tool() {
    return std::make_unique<GizmoTool>();
}

}  // namespace neuvv::viewer

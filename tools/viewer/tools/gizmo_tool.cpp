#include <imgui.h>

#include "edit/operations.h"
#include "tools/viewer/tools/image_tools.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

namespace {

GizmoMode mode_of(Tool tool) {
    if (tool == Tool::kRotate) return GizmoMode::kRotate;
    return tool == Tool::kScale ? GizmoMode::kScale : GizmoMode::kMove;
}

std::optional<Gizmo> gizmo_of_selected(const Viewer& viewer) {
    const stage::Stage* stage = viewer.stage_of_document();
    const std::optional<uint32_t> node = viewer.editor.selected();
    if (!stage || !node || viewer.tool == Tool::kPaint || edit::is_locked(viewer.editor.file(), *node))
        return std::nullopt;
    if (*node >= stage->scene.nodes.size() || !stage->scene.nodes[*node].in_scene) return std::nullopt;
    return Gizmo{viewer.camera, viewer.evaluated.pose.world_from_node[*node], mode_of(viewer.tool),
                 viewer.local_axes ? GizmoAxes::kLocal : GizmoAxes::kWorld, viewer.ui(90)};
}

void grab(Viewer& viewer, const Gizmo& gizmo, GizmoHandle handle) {
    const uint32_t node = *viewer.editor.selected();
    viewer.gizmo = HeldGizmo{gizmo, handle, pointer_of(viewer), node, world_from_parent(viewer, node)};
}

void drag(Viewer& viewer, const HeldGizmo& held) {
    const bool snap = viewer.snap != ImGui::GetIO().KeyCtrl;
    const glm::dmat4 world = dragged(held.grabbed, held.handle, held.from, pointer_of(viewer), snap);
    const auto local = parent_from_node(held.world_from_parent, world);
    if (!local) return;
    Gizmo shown = held.grabbed;
    shown.world_from_node = world;
    show_handles(viewer, gizmo_shapes(shown), static_cast<int>(held.handle));
    viewer.editor.drag([&](edit::Document& d) {
        edit::Placement placement;
        placement.to = *local;
        return edit::place_node(d.file, held.node, placement);
    });
}

// The middle of each.
void report_handles(Viewer& viewer, std::span<const HandleShape> shapes) {
    constexpr const char* kNames[] = {"", "x", "y", "z", "yz", "zx", "xy", "centre"};
    for (const HandleShape& shape : shapes) {
        if (shape.handle == 0 || shape.count == 0) continue;
        glm::dvec2 low(shape.points[0]), high = low;
        for (uint32_t i = 1; i < shape.count; i++) {
            low = glm::min(low, glm::dvec2(shape.points[i]));
            high = glm::max(high, glm::dvec2(shape.points[i]));
        }
        const glm::vec2 at(low), size(high - low);
        viewer.report.place(std::string("gizmo/") + kNames[shape.handle], viewer.image_area.left + at.x,
                            viewer.image_area.top + at.y, size.x, size.y);
    }
}

}  // namespace

bool gizmo_tool(Viewer& viewer, bool taken) {
    if (viewer.gizmo) {
        if (keeps_hold(viewer))
            drag(viewer, *viewer.gizmo);
        else
            viewer.gizmo.reset();
        return true;
    }
    const std::optional<Gizmo> gizmo = gizmo_of_selected(viewer);
    if (!gizmo) return false;
    const bool free = viewer.pointer_in_image && !taken;
    const GizmoHandle handle = free ? gizmo_handle_at(*gizmo, pointer_of(viewer)) : GizmoHandle::kNone;
    const std::vector<HandleShape> shapes = gizmo_shapes(*gizmo);
    report_handles(viewer, shapes);
    show_handles(viewer, shapes, static_cast<int>(handle));
    if (handle == GizmoHandle::kNone) return false;
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) grab(viewer, *gizmo, handle);
    return true;
}

}  // namespace neuvv::viewer

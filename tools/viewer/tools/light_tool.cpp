// Handles of the selected light: where it shines, how wide, how far.
#include <imgui.h>

#include "edit/operations.h"
#include "tools/viewer/tools/image_tools.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

namespace {

constexpr double kReach_m = 3;  // of an aim that nothing stops

// As far as the middle of the performers, so that the aim lies among them.
std::optional<LightGizmo> gizmo_of_selected(const Viewer& viewer) {
    const std::optional<uint32_t> node = viewer.editor.selected();
    if (!node || !viewer.stage_of_document() || edit::is_locked(viewer.editor.file(), *node)) return std::nullopt;
    for (const stage::EvaluatedLight& light : viewer.evaluated.lights) {
        if (light.node != *node) continue;
        const auto [low, high] = stage::performers_box(*viewer.stage, viewer.evaluated);
        const double along = glm::dot((low + high) / 2.0 - light.position, light.direction);
        return LightGizmo{viewer.camera, aimed_light(light, along > 0.1 ? along : kReach_m)};
    }
    return std::nullopt;
}

// What changed of the light, as one operation.
std::string set_aimed(stage::StageFile& file, const HeldLight& held, const AimedLight& light) {
    edit::LightEdit edit;
    edit::Placement placement;
    std::string said;
    if (held.handle == LightHandle::kAim) {
        placement.aim = glm::dvec3(glm::inverse(held.world_from_parent) * glm::dvec4(light.aim, 1));
        return edit::place_node(file, held.node, placement);
    }
    if (held.handle == LightHandle::kRange) edit.range_m = light.range_m;
    if (held.handle == LightHandle::kRim) {
        edit.outer_cone_deg = glm::degrees(light.outer_cone_rad);
        edit.inner_cone_deg = glm::degrees(light.inner_cone_rad);
    }
    return edit::set_light(file, held.node, edit);
}

void drag(Viewer& viewer, const HeldLight& held) {
    const bool snap = viewer.snap != ImGui::GetIO().KeyCtrl;
    LightGizmo shown = held.grabbed;
    shown.light = dragged(held.grabbed, held.handle, held.from, pointer_of(viewer), snap);
    show_handles(viewer, light_shapes(shown), static_cast<int>(held.handle));
    viewer.editor.drag([&](edit::Document& d) { return set_aimed(d.file, held, shown.light); });
}

void grab(Viewer& viewer, const LightGizmo& gizmo, LightHandle handle) {
    const uint32_t node = *viewer.editor.selected();
    viewer.held_light = HeldLight{gizmo, handle, pointer_of(viewer), node, world_from_parent(viewer, node)};
}

}  // namespace

bool light_tool(Viewer& viewer, bool taken) {
    if (viewer.held_light) {
        if (keeps_hold(viewer))
            drag(viewer, *viewer.held_light);
        else
            viewer.held_light.reset();
        return true;
    }
    const std::optional<LightGizmo> gizmo = gizmo_of_selected(viewer);
    if (!gizmo) return false;
    const bool free = viewer.pointer_in_image && !taken;
    const LightHandle handle = free ? light_handle_at(*gizmo, pointer_of(viewer)) : LightHandle::kNone;
    show_handles(viewer, light_shapes(*gizmo), static_cast<int>(handle));
    if (handle == LightHandle::kNone) return false;
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) grab(viewer, *gizmo, handle);
    return true;
}

}  // namespace neuvv::viewer

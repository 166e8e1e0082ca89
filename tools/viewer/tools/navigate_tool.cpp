#include <GLFW/glfw3.h>
#include <imgui.h>

#include "editor/picking.h"
#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

constexpr float kClick_px = 4;  // farther it is a drag

Hold hold_of(int button, const ImGuiIO& io) {
    if (button == ImGuiMouseButton_Middle || (button == ImGuiMouseButton_Left && io.KeyShift)) return Hold::kPan;
    if (button == ImGuiMouseButton_Right) return Hold::kTurn;
    return Hold::kOrbit;
}

// Mouse and touchpad; each goes on with what it began, wherever the pointer goes.
void look_around(Viewer& viewer, bool left_is_free) {
    Grip& grip = viewer.grip;
    const ImGuiIO& io = ImGui::GetIO();
    for (int button = 0; button < 3; button++) {
        const bool free = button != ImGuiMouseButton_Left || left_is_free;
        if (!free || !viewer.pointer_in_image || grip.hold != Hold::kNothing || !ImGui::IsMouseClicked(button))
            continue;
        grip = {hold_of(button, io), button, false};
    }
    if (grip.hold == Hold::kNothing) return;
    const ImVec2 way = ImGui::GetMouseDragDelta(grip.button, 0);
    if (std::abs(way.x) + std::abs(way.y) > viewer.ui(kClick_px)) grip.moved = true;
    const glm::dvec2 moved(io.MouseDelta.x, io.MouseDelta.y);
    const double height = viewer.image_area.height;
    if (grip.moved && moved != glm::dvec2(0)) {
        if (grip.hold == Hold::kOrbit) viewer.eye = orbited(viewer.eye, moved, height);
        if (grip.hold == Hold::kPan) viewer.eye = panned(viewer.eye, moved, height);
        if (grip.hold == Hold::kTurn) viewer.eye = turned(viewer.eye, moved, height);
        viewer.moves();
    }
}

// Lights and cameras by their signs at once; the rest when the drawer has looked.
void select_at(Viewer& viewer, float x, float y) {
    if (const auto node = sign_at(viewer, x, y)) return viewer.editor.select(node);
    if (!viewer.stage) return;
    const glm::dvec2 pixel(x - viewer.image_area.left, y - viewer.image_area.top);
    viewer.render_thread.post([&viewer, pixel, camera = viewer.camera, time_s = viewer.clock.shown_s(),
                               id = viewer.editor.id(), drawn = viewer.stage](editor::OnDevice& on_device) {
        if (&on_device.stage != drawn.get()) return;  // its nodes may have other numbers
        const editor::Seen seen = editor::seen_at(on_device, stage::stage_at(on_device.stage, time_s), camera, pixel);
        viewer.jobs.post([&viewer, seen, id] {
            if (viewer.editor.id() == id) viewer.editor.select(seen.node);
            viewer.redraw();
        });
    });
}

void let_go(Viewer& viewer) {
    Grip& grip = viewer.grip;
    if (grip.hold == Hold::kNothing || ImGui::IsMouseDown(grip.button)) return;
    const ImVec2 at = ImGui::GetIO().MousePos;
    if (grip.button == ImGuiMouseButton_Left && !grip.moved) select_at(viewer, at.x, at.y);
    grip = {};
}

void scroll(Viewer& viewer) {
    const ImGuiIO& io = ImGui::GetIO();
    if (!viewer.pointer_in_image || (io.MouseWheel == 0 && io.MouseWheelH == 0)) return;
    viewer.eye =
        scrolled(viewer.eye, {{io.MouseWheelH, io.MouseWheel}, io.KeyShift, io.KeyCtrl}, viewer.image_area.height);
    viewer.moves();
}

void fly(Viewer& viewer) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput || io.KeyCtrl) return;
    const auto axis = [&](int plus, int minus) {
        return (viewer.window.is_down(plus) ? 1.0 : 0.0) - (viewer.window.is_down(minus) ? 1.0 : 0.0);
    };
    const FlightKeys keys{axis(GLFW_KEY_W, GLFW_KEY_S), axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q),
                          io.KeyShift, io.KeyAlt};
    if (keys.forward == 0 && keys.right == 0 && keys.up == 0) return;
    double scene_m = 2;
    if (viewer.stage) {
        const auto [low, high] = stage::performers_box(*viewer.stage, viewer.evaluated);
        scene_m = glm::length(high - low);
    }
    viewer.eye = flown(viewer.eye, keys, viewer.dt_s, scene_m);
    viewer.moves();
}

// The left button is theirs where this is true.
bool hold_handles(Viewer& viewer) {
    const bool navigating = viewer.grip.hold != Hold::kNothing;
    const bool by_light = viewer.held_light && light_tool(viewer, navigating);
    const bool by_gizmo = gizmo_tool(viewer, navigating || by_light);
    const bool free_light = !by_light && light_tool(viewer, navigating || by_gizmo);  // drawn in any case
    viewer.holds_handle = viewer.gizmo || viewer.held_light;
    return by_light || by_gizmo || free_light;
}

}  // namespace

void image_panel(Viewer& viewer) {
    toolbar(viewer);
    const ImGuiIO& io = ImGui::GetIO();
    viewer.pointer_in_image = !io.WantCaptureMouse && viewer.image_area.holds(io.MousePos.x, io.MousePos.y);
    const PaintHands paints = viewer.paint.in_image(viewer);
    const bool handle = !paints.left && !paints.all && hold_handles(viewer);
    if (!paints.all) look_around(viewer, !handle && !paints.left);
    let_go(viewer);
    if (!paints.wheel) scroll(viewer);
    if (!paints.all) fly(viewer);
    draw_overlay(viewer);
}

}  // namespace neuvv::viewer

// What is held in the image: handles of the selected node, and what is drawn over the image.
#pragma once

#include <optional>

#include "tools/viewer/tools/gizmo.h"
#include "tools/viewer/tools/light_gizmo.h"

namespace neuvv::ui {
struct KeyPress;
}

namespace neuvv::viewer {

class Viewer;
struct Area;

// A handle that is held, and its gizmo as it was when it was grabbed.
template <typename OfWhat, typename Handle>
struct Held {
    OfWhat grabbed;
    Handle handle;
    glm::dvec2 from{0};  // in the image
    uint32_t node = 0;
    glm::dmat4 world_from_parent{1};
};
using HeldGizmo = Held<Gizmo, GizmoHandle>;
using HeldLight = Held<LightGizmo, LightHandle>;

// Whether a handle that is held stays so: until the button is let go, or Escape, which takes the drag back.
bool keeps_hold(Viewer& viewer);
// Of the drawn stage's node.
glm::dmat4 world_from_parent(const Viewer& viewer, uint32_t node);

// Before the image's own navigation, each frame. True: a handle is held or under the pointer, which then does nothing
// else. `taken`: the pointer is on something already.
bool gizmo_tool(Viewer& viewer, bool taken);
bool light_tool(Viewer& viewer, bool taken);
// Handles to be drawn over the image in this frame, `hot` the one that is held or under the pointer.
void show_handles(Viewer& viewer, std::span<const HandleShape> shapes, int hot);
// The pointer's place in the image.
glm::dvec2 pointer_of(const Viewer& viewer);

// A floor of lines, lights, cameras, the box of what is selected.
void draw_overlay(Viewer& viewer);
// The node of a light's or camera's sign under a place of the window; none.
std::optional<uint32_t> sign_at(const Viewer& viewer, float x, float y);

// 1 2 3 tools, F focus, G grid, the number pad's views.
void take_image_key(Viewer& viewer, const ui::KeyPress& press);

// Shows the selection, else all performers.
void focus(Viewer& viewer);
// As a camera of the stage.
void remember_view(Viewer& viewer);

// Buttons of the tools, at the image's left.
void toolbar(Viewer& viewer);

// The box of a node and what hangs on it, world, low and high: its performers, its meshes; its place where it has none.
std::pair<glm::dvec3, glm::dvec3> box_of_node(const Viewer& viewer, uint32_t node);

}  // namespace neuvv::viewer

// The drag state of a gizmo's handle, shared by the tools that have handles.
#pragma once

#include <imgui.h>

#include "tools/viewer/context.h"

namespace neuvv::viewer {

// A handle that is being dragged. `grabbed` is the gizmo at the time when the handle was grabbed; the result of the
// drag is computed from it.
template <typename GizmoType, typename Handle>
struct HandleDrag {
    GizmoType grabbed;
    Handle handle;
    glm::dvec2 from{0};  // where the pointer was then, in pixels of the image
    uint32_t node = 0;
    glm::dmat4 world_from_parent{1};  // of the node's parent
};

// Whether the drag goes on: until the left button is released, or Escape cancels it and restores the document.
inline bool drag_goes_on(Context& context) {
    if (context.frame.escape) context.editor.cancel_drag();
    return !context.frame.escape && ImGui::IsMouseDown(ImGuiMouseButton_Left);
}

// The transform of the parent of a node of the drawn stage; the identity where it has no parent.
inline glm::dmat4 world_from_parent(const Context& context, uint32_t node) {
    const int32_t parent = context.frame.stage->scene.nodes[node].parent;
    return parent < 0 ? glm::dmat4(1) : context.frame.evaluated.pose.world_from_node[static_cast<size_t>(parent)];
}

}  // namespace neuvv::viewer

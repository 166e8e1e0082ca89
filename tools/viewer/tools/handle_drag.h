// The drag of a handle: what it was grabbed on, and whether it goes on.
#pragma once

#include <imgui.h>

#include "tools/viewer/context.h"

namespace neuvv::viewer {

// A handle that is dragged. The gizmo stays as it was when the handle was grabbed: a drag is computed from there.
template <typename GizmoType, typename Handle>
struct HandleDrag {
    GizmoType grabbed;
    Handle handle;
    glm::dvec2 from{0};  // the pointer then, in pixels of the image
    uint32_t node = 0;
    glm::dmat4 world_from_parent{1};  // of the node
};

// Until the left button is released. Escape ends it, too, and the document is as it was before.
inline bool drag_goes_on(Context& context) {
    if (context.frame.escape) context.editor.cancel_drag();
    return !context.frame.escape && ImGui::IsMouseDown(ImGuiMouseButton_Left);
}

// Of a node of the stage that is drawn.
inline glm::dmat4 world_from_parent(const Context& context, uint32_t node) {
    const int32_t parent = context.frame.stage->scene.nodes[node].parent;
    return parent < 0 ? glm::dmat4(1) : context.frame.evaluated.pose.world_from_node[static_cast<size_t>(parent)];
}

}  // namespace neuvv::viewer

// A tool that draws a gizmo, lets its handles be dragged, and changes the selected node by that: what the gizmo of
// nodes and the gizmo of lights have in common.
#pragma once

#include <imgui.h>

#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/tool.h"

namespace neuvv::viewer {

// The transform of the parent of a node of the drawn stage; the identity where it has no parent.
inline glm::dmat4 world_from_parent(const Context& context, uint32_t node) {
    const int32_t parent = context.frame.stage->scene.nodes[node].parent;
    return parent < 0 ? glm::dmat4(1) : context.frame.evaluated.pose.world_from_node[static_cast<size_t>(parent)];
}

// `Handle` is an enumeration of the gizmo's handles with kNone = 0.
template <typename GizmoType, typename Handle>
class HandleTool : public Tool {
  public:
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
        const std::optional<GizmoType> gizmo = gizmo_of_selected(context);
        if (!gizmo) return;
        const bool free = context.frame.pointer_in_image && !use.left && !use.all;
        const Handle handle = free ? handle_at(*gizmo, pointer_of(context)) : Handle::kNone;
        show(*gizmo, handle);
        report_shapes(context, shapes_);
        if (handle == Handle::kNone) return;
        use.left = true;
        const uint32_t node = *context.editor.selected();
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Left))
            drag_ = {*gizmo, handle, pointer_of(context), node, world_from_parent(context, node)};
    }

  protected:
    // A handle that is being dragged. `grabbed` is the gizmo at the time when the handle was grabbed; the result of the
    // drag is computed from it.
    struct Drag {
        GizmoType grabbed;
        Handle handle;
        glm::dvec2 from{0};  // where the pointer was then, in pixels of the image
        uint32_t node = 0;
        glm::dmat4 parent{1};  // world_from_parent of the node
    };

    // Nothing where the selected node has no such gizmo, or another tool is the current one.
    virtual std::optional<GizmoType> gizmo_of_selected(const Context& context) const = 0;
    virtual std::vector<HandleShape> shapes_of(const GizmoType& gizmo) const = 0;
    virtual Handle handle_at(const GizmoType& gizmo, glm::dvec2 pointer) const = 0;
    // The gizmo after a drag to `pointer`; `snap`: in steps.
    virtual GizmoType moved(const Drag& drag, glm::dvec2 pointer, bool snap) const = 0;
    // The operation of Editor::drag that gives the node what the gizmo shows now.
    virtual std::string apply(stage::StageFile& file, const Drag& drag, const GizmoType& gizmo) const = 0;
    virtual void report_shapes(const Context&, std::span<const HandleShape>) const {}

  private:
    // Until the left button is released, or Escape cancels the drag and restores the document.
    static bool drag_goes_on(Context& context) {
        if (context.frame.escape) context.editor.cancel_drag();
        return !context.frame.escape && ImGui::IsMouseDown(ImGuiMouseButton_Left);
    }

    void show(const GizmoType& gizmo, Handle hot) {
        shapes_ = shapes_of(gizmo);
        hot_ = static_cast<int>(hot);
    }

    void drag(Context& context) {
        const GizmoType now = moved(*drag_, pointer_of(context), context.view.snap != ImGui::GetIO().KeyCtrl);
        show(now, drag_->handle);
        context.editor.drag([&](edit::Document& document) { return apply(document.file, *drag_, now); });
    }

    std::optional<Drag> drag_;
    std::vector<HandleShape> shapes_;
    int hot_ = 0;  // the handle that is dragged or under the pointer; 0: none
};

}  // namespace neuvv::viewer

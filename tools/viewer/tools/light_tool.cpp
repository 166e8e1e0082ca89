// The tool with the handles of the selected light: its aim, its cone and its range.
#include "edit/operations.h"
#include "tools/viewer/tools/handle_drag.h"
#include "tools/viewer/tools/light_gizmo.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/paint_tool.h"
#include "tools/viewer/tools/tools.h"

namespace neuvv::viewer {

namespace {

constexpr double kAimDistance_m = 3;  // distance of the aim of a light that shines away from the performers

// The gizmo of the selected light; nullopt: none is selected, or painting is the current mode. The aim is as far away
// as the middle of the performers.
std::optional<LightGizmo> gizmo_of_selected(const Context& context) {
    const std::optional<uint32_t> node = context.editor.selected();
    const stage::Stage* stage = context.stage_of_document();
    if (!node || !stage || PaintTool::is_current(context) || edit::is_locked(context.editor.file(), *node))
        return std::nullopt;
    for (const stage::EvaluatedLight& light : context.frame.evaluated.lights) {
        if (light.node != *node) continue;
        const auto [low, high] = stage::performers_box(*stage, context.frame.evaluated);
        const double along = glm::dot((low + high) / 2.0 - light.position, light.direction);
        return LightGizmo{context.frame.camera, aimed_light(light, along > 0.1 ? along : kAimDistance_m)};
    }
    return std::nullopt;
}

using LightDrag = HandleDrag<LightGizmo, LightHandle>;

// Sets the values that the handle changes, as one operation.
std::string set_light(stage::StageFile& file, const LightDrag& drag, const AimedLight& light) {
    edit::LightEdit edit;
    if (drag.handle == LightHandle::kAim) {
        edit::Placement placement;
        placement.aim = glm::dvec3(glm::inverse(drag.world_from_parent) * glm::dvec4(light.aim, 1));
        return edit::place_node(file, drag.node, placement);
    }
    if (drag.handle == LightHandle::kRange) edit.range_m = light.range_m;
    if (drag.handle == LightHandle::kRim) {
        edit.outer_cone_deg = glm::degrees(light.outer_cone_rad);
        edit.inner_cone_deg = glm::degrees(light.inner_cone_rad);
    }
    return edit::set_light(file, drag.node, edit);
}

class LightTool : public Tool {
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
        const std::optional<LightGizmo> gizmo = gizmo_of_selected(context);
        if (!gizmo) return;
        const bool free = context.frame.pointer_in_image && !use.left && !use.all;
        const LightHandle handle = free ? light_handle_at(*gizmo, pointer_of(context)) : LightHandle::kNone;
        show(*gizmo, handle);
        if (handle == LightHandle::kNone) return;
        use.left = true;
        const uint32_t node = *context.editor.selected();
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Left))
            drag_ = {*gizmo, handle, pointer_of(context), node, world_from_parent(context, node)};
    }

  private:
    void show(const LightGizmo& gizmo, LightHandle hot) {
        shapes_ = light_shapes(gizmo);
        hot_ = static_cast<int>(hot);
    }

    void drag(Context& context) {
        const bool snap = context.view.snap != ImGui::GetIO().KeyCtrl;
        LightGizmo moved = drag_->grabbed;
        moved.light = dragged(drag_->grabbed, drag_->handle, drag_->from, pointer_of(context), snap);
        show(moved, drag_->handle);
        context.editor.drag([&](edit::Document& document) { return set_light(document.file, *drag_, moved.light); });
    }

    std::optional<LightDrag> drag_;
    std::vector<HandleShape> shapes_;
    int hot_ = 0;
};

}  // namespace

std::unique_ptr<Tool> make_light_tool() {
    return std::make_unique<LightTool>();
}

}  // namespace neuvv::viewer

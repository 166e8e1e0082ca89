// The tool with the handles of the selected light: its aim, its cone and its range.
#include "edit/operations.h"
#include "tools/viewer/tools/handle_tool.h"
#include "tools/viewer/tools/light_gizmo.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/paint_tool.h"
#include "tools/viewer/tools/tools.h"

namespace neuvv::viewer {

namespace {

constexpr double kAimDistance_m = 3;  // distance of the aim of a light that shines away from the performers

// The gizmo of the selected light; nullopt: none is selected, or painting is the current mode. The aim is as far away
// as the centre of the performers.
std::optional<LightGizmo> light_gizmo_in(const Context& context) {
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

class LightTool : public HandleTool<LightGizmo, LightHandle> {
  protected:
    std::optional<LightGizmo> gizmo_of_selected(const Context& context) const override {
        return light_gizmo_in(context);
    }
    std::vector<HandleShape> shapes_of(const LightGizmo& gizmo) const override { return light_shapes(gizmo); }
    LightHandle handle_at(const LightGizmo& gizmo, glm::dvec2 pointer) const override {
        return light_handle_at(gizmo, pointer);
    }
    LightGizmo moved(const Drag& drag, glm::dvec2 pointer, bool snap) const override {
        LightGizmo gizmo = drag.grabbed;
        gizmo.light = dragged(gizmo, drag.handle, drag.from, pointer, snap);
        return gizmo;
    }
    std::string apply(stage::StageFile& file, const Drag& drag, const LightGizmo& gizmo) const override {
        const AimedLight& light = gizmo.light;
        if (drag.handle == LightHandle::kAim) {
            edit::Placement placement;
            placement.aim = glm::dvec3(glm::inverse(drag.parent) * glm::dvec4(light.aim, 1));
            return edit::place_node(file, drag.node, placement);
        }
        edit::LightEdit edit;
        if (drag.handle == LightHandle::kRange) edit.range_m = light.range_m;
        if (drag.handle == LightHandle::kRim) {
            edit.outer_cone_deg = glm::degrees(light.outer_cone_rad);
            edit.inner_cone_deg = glm::degrees(light.inner_cone_rad);
        }
        return edit::set_light(file, drag.node, edit);
    }
};

}  // namespace

std::unique_ptr<Tool> make_light_tool() {
    return std::make_unique<LightTool>();
}

}  // namespace neuvv::viewer

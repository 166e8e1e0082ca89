// The tool that moves the eye by mouse, touchpad and keys, and selects what is clicked.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include "editor/picking.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/tools.h"

namespace neuvv::viewer {

namespace {

constexpr float kClick_px = 4;  // where the pointer moves farther, a button drags; at scale 1

enum class Motion { kOrbit, kPan, kTurn };

Motion motion_of(int button, const ImGuiIO& io) {
    if (button == ImGuiMouseButton_Middle || (button == ImGuiMouseButton_Left && io.KeyShift)) return Motion::kPan;
    return button == ImGuiMouseButton_Right ? Motion::kTurn : Motion::kOrbit;
}

struct Click {
    glm::dvec2 pixel;
    stage::Camera camera;
    double time_s;
};

// Selects the node that the render thread traces at a click. Where the stage that it has is still another one than the
// document, as just after an edit, its nodes may have other numbers: then it traces the click again.
void select_clicked(Context& context, const Click& click) {
    context.render_thread.post([&context, click](editor::OnDevice& on_device) {
        const editor::PickedPoint picked =
            editor::pick_at(on_device, stage::stage_at(on_device.stage, click.time_s), click.camera, click.pixel);
        context.jobs.post([&context, click, picked, nodes = on_device.stage.scene.nodes.size()] {
            context.redraw();
            const bool is_behind = context.frame.rendered.stage_id != context.editor.id();
            if (context.editor.is_open() && nodes == context.editor.node_count())
                context.editor.select(picked.node);
            else if (is_behind && context.frame.rendered.problem.empty())
                select_clicked(context, click);
        });
    });
}

// Lights and cameras are selected by their icons at once.
void select_at(Context& context, glm::vec2 at) {
    if (const auto node = icon_at(context, at.x, at.y)) return context.editor.select(node);
    const FrameInput& frame = context.frame;
    if (!frame.stage) return;
    const glm::dvec2 pixel(at.x - frame.image_area.left, at.y - frame.image_area.top);
    select_clicked(context, {pixel, frame.camera, context.view.clock.displayed_s()});
}

void scroll(Context& context) {
    const ImGuiIO& io = ImGui::GetIO();
    if (!context.frame.pointer_in_image || (io.MouseWheel == 0 && io.MouseWheelH == 0)) return;
    context.view.eye = scrolled(context.view.eye, {{io.MouseWheelH, io.MouseWheel}, io.KeyShift, io.KeyCtrl},
                                context.frame.image_area.height);
    context.mark_motion();
}

void fly(Context& context) {
    const FlightKeys& keys = context.frame.flight_keys;
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput || io.KeyCtrl || (keys.forward == 0 && keys.right == 0 && keys.up == 0)) return;
    double scene_m = 2;
    if (context.frame.stage) {
        const auto [low, high] = stage::performers_box(*context.frame.stage, context.frame.evaluated);
        scene_m = glm::length(high - low);
    }
    context.view.eye = flown(context.view.eye, keys, context.frame.dt_s, scene_m);
    context.mark_motion();
}

class NavigateTool : public Tool {
  public:
    bool captures_pointer() const override { return drag_.has_value(); }

    void handle_key(Context& context, const ui::KeyPress& press) override {
        const auto look_from = [&](EyeSide side, EyeSide opposite) {
            context.go_to(seen_from(context.view.eye, press.control ? opposite : side));
        };
        if (press.key == GLFW_KEY_KP_1) look_from(EyeSide::kFront, EyeSide::kBack);
        if (press.key == GLFW_KEY_KP_3) look_from(EyeSide::kRight, EyeSide::kLeft);
        if (press.key == GLFW_KEY_KP_7) look_from(EyeSide::kTop, EyeSide::kBottom);
        if (press.key == GLFW_KEY_B && press.control) remember_view(context);
        if (press.key == GLFW_KEY_F && !press.control && !press.alt) focus(context);
    }

    void handle_pointer(Context& context, PointerUse& use) override {
        if (!use.all) begin(context, use);
        if (drag_) {
            use.left = true;
            if (!use.all) continue_drag(context);
            if (!ImGui::IsMouseDown(drag_->button)) end(context);
        }
        if (!use.wheel) scroll(context);
        if (!use.all) fly(context);
    }

  private:
    // Begins where the button goes down in the image, and goes on wherever the pointer goes.
    struct Drag {
        Motion motion;
        int button;
        bool moved;  // farther than kClick_px; else it is a click
    };

    void begin(Context& context, const PointerUse& use) {
        for (int button = 0; button < 3; ++button) {
            const bool free = button != ImGuiMouseButton_Left || !use.left;
            if (free && !drag_ && context.frame.pointer_in_image && ImGui::IsMouseClicked(button))
                drag_ = Drag{motion_of(button, ImGui::GetIO()), button, false};
        }
    }

    void continue_drag(Context& context) {
        const ImGuiIO& io = ImGui::GetIO();
        const ImVec2 total = ImGui::GetMouseDragDelta(drag_->button, 0);
        if (std::abs(total.x) + std::abs(total.y) > context.ui(kClick_px)) drag_->moved = true;
        const glm::dvec2 step(io.MouseDelta.x, io.MouseDelta.y);
        if (!drag_->moved || step == glm::dvec2(0)) return;
        constexpr decltype(&orbited) kMotions[] = {orbited, panned, turned};  // by Motion
        context.view.eye =
            kMotions[static_cast<size_t>(drag_->motion)](context.view.eye, step, context.frame.image_area.height);
        context.mark_motion();
    }

    void end(Context& context) {
        const ImVec2 at = ImGui::GetIO().MousePos;
        if (drag_->button == ImGuiMouseButton_Left && !drag_->moved) select_at(context, {at.x, at.y});
        drag_.reset();
    }

    std::optional<Drag> drag_;
};

}  // namespace

std::unique_ptr<Tool> make_navigate_tool() {
    return std::make_unique<NavigateTool>();
}

}  // namespace neuvv::viewer

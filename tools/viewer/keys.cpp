#include "tools/viewer/keys.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include "tools/viewer/timeline/camera_path_view.h"

namespace neuvv::viewer {

namespace {

void handle_control_key(Context& context, const KeyUses& uses, const ui::KeyPress& press) {
    switch (press.key) {
        case GLFW_KEY_Z:
            return press.shift ? context.editor.redo() : context.editor.undo();
        case GLFW_KEY_Y:
            return context.editor.redo();
        case GLFW_KEY_S:
            return press.shift ? uses.files.save_as() : uses.files.save();
        case GLFW_KEY_N:
            return uses.files.new_stage();
        case GLFW_KEY_O:
            return uses.files.ask_to_open();
        case GLFW_KEY_Q:
            return uses.window.close();
        default:
            return;
    }
}

void handle_key(Context& context, const KeyUses& uses, const ui::KeyPress& press) {
    ViewState& view = context.view;
    editor::StageClock& clock = view.clock;
    if (press.control) handle_control_key(context, uses, press);
    uses.tools.handle_key(context, press);
    if (press.control || press.alt) return;
    if (press.key == GLFW_KEY_COMMA) clock.step(-1);
    if (press.key == GLFW_KEY_PERIOD) clock.step(1);
    if (press.repeat) return;
    if (press.key == GLFW_KEY_SPACE) clock.play_or_pause();
    if (press.key == GLFW_KEY_HOME) clock.scrub(clock.in_s());
    if (press.key == GLFW_KEY_END) clock.scrub(clock.last_s());
    const Area& area = context.frame.image_area;
    const bool beside_fields = ImGui::GetIO().MousePos.x < area.left + area.width;
    if (beside_fields && (press.key == GLFW_KEY_ENTER || press.key == GLFW_KEY_KP_ENTER))
        press.shift ? remove_nearest_key(context) : add_key_here(context);
    if (press.key == GLFW_KEY_M) view.sound = !view.sound;
    if (press.key == GLFW_KEY_TAB) view.panels.all = !view.panels.all;
    if (press.key == GLFW_KEY_F11) uses.window.toggle_full_screen();
    if (press.key == GLFW_KEY_F12) press.shift ? uses.screenshots.request_window() : uses.screenshots.request_image();
}

}  // namespace

void handle_keys(Context& context, const KeyUses& uses) {
    const bool typing = ImGui::GetIO().WantTextInput, asked = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
    if (!typing && !asked && !uses.tools.is_editing()) {
        for (const ui::KeyPress& press : context.frame.presses) handle_key(context, uses, press);
        handle_node_keys(context, uses.tree);
    }
    PanelLayout& panels = context.view.panels;
    if (!typing && context.frame.typed.find(U'?') != std::u32string::npos) panels.help = !panels.help;
}

}  // namespace neuvv::viewer

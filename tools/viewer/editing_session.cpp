#include "tools/viewer/editing_session.h"

#include "tools/viewer/eye_motion.h"

namespace neuvv::viewer {

EditingSession::EditingSession(const gpu::Device& device, const std::filesystem::path& report_file)
    : report(report_file),
      jobs([this](const std::string& problem) { editor.notify(problem, true); }, ui::Window::wake),
      render_thread(device, ui::Window::wake) {}

void EditingSession::read_render_thread() {
    const uint64_t displayed_before = input.rendered.displayed.number;
    input.rendered = render_thread.state();
    if (input.rendered.displayed.number != displayed_before) context.redraw(1);
}

void EditingSession::receive_stage() {
    const std::shared_ptr<const stage::Stage> read = input.rendered.stage;
    if (read && read != input.stage) {
        const bool first = !input.stage || input.stage->file.path != read->file.path;
        input.stage = read;
        editor.stage_made(*read, input.rendered.stage_id);
        view.clock.set_stage(read->duration_s, read->fps);
        input.evaluated = stage::stage_at(*read, view.clock.displayed_s());
        if (first) view.eye = initial_eye(context, stage::stage_at(*read, 0));
    }
    const bool can_take_back = editor.dragging() || editor.history().next_undo();
    if (can_take_back && input.rendered.unsound_id == editor.id()) editor.take_back(input.rendered.problem);
}

void EditingSession::evaluate() {
    if (input.stage) input.evaluated = stage::stage_at(*input.stage, view.clock.displayed_s());
}

}  // namespace neuvv::viewer

#include "editor/paint/paint_task.h"

#include "base/error.h"

namespace neuvv::editor {

namespace {

// Runs one step of the task. Returns whether the task has ended, by its result or by an error.
bool run(Parts parts, OnDevice& on, PaintSurface& surface, const std::filesystem::path& file, const PaintClip& clip,
         const PaintTask& task, const JobQueue::Then& failed) {
    JobQueue::Then then;
    try {
        const std::shared_ptr<const render::Field> field = field_of(on, file, clip);
        if (!field) return false;
        then = task(surface, field);
        if (!then) return false;
    } catch (const std::exception& error) {
        surface.clear();
        then = [parts, failed, problem = std::string(error.what())] {
            parts.editor.notify(problem, true);
            failed();
        };
    }
    parts.jobs.post(std::move(then));
    return true;
}

}  // namespace

std::shared_ptr<const render::Field> field_of(OnDevice& on, const std::filesystem::path& file, const PaintClip& clip) {
    if (auto field = on.renderer.find_field(file, clip.field)) return field;
    if (on.renderer.awaits(file)) return nullptr;
    throw InputError(file.string(), "", "was written anew since it was read, or is not played any more", "paint again");
}

// Each further step is posted by way of the editor's thread, so that other requests to the render thread come in
// between.
void post_paint_task(Parts parts, const std::shared_ptr<PaintSurface>& surface, const std::filesystem::path& file,
                     const std::shared_ptr<const PaintClip>& clip, const PaintTask& task,
                     const JobQueue::Then& failed) {
    parts.render_thread.post([=](OnDevice& on) {
        if (run(parts, on, *surface, file, *clip, task, failed)) return;
        parts.jobs.post([=] { post_paint_task(parts, surface, file, clip, task, failed); });
    });
}

}  // namespace neuvv::editor

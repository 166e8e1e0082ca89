#include "tools/viewer/paint_task.h"

#include "base/error.h"

namespace neuvv::viewer {

namespace {

// Whether it has come to an end, well or not.
bool run(Viewer& viewer, OnDevice& on, PaintDesk& desk, const std::filesystem::path& path, const PaintClip& clip,
         const PaintTask& task, const Work::Then& failed) {
    Work::Then then;
    try {
        then = task(desk, field_of(on, path, clip));
        if (!then) return false;
    } catch (const std::exception& error) {
        desk.clear();
        then = [&viewer, failed, problem = std::string(error.what())] {
            viewer.editor.tell(problem, true);
            failed();
        };
    }
    viewer.work.tell(std::move(then));
    return true;
}

}  // namespace

std::shared_ptr<const render::Field> field_of(OnDevice& on, const std::filesystem::path& path, const PaintClip& clip) {
    for (uint32_t i = 0; i < on.stage.clips.size(); i++) {
        if (on.stage.clips[i].path != path) continue;
        if (on.renderer.painted_field(i) == clip.field) return on.renderer.shared_field(i);
        throw InputError(path.string(), "", "was written anew since it was read", "paint again");
    }
    throw InputError(path.string(), "", "is not on the stage any more", "select another performer");
}

// The window's thread posts the next step, so that what else is to be drawn comes in between.
void post_paint_task(Viewer& viewer, std::shared_ptr<PaintDesk> desk, const std::filesystem::path& path,
                     std::shared_ptr<const PaintClip> clip, PaintTask task, Work::Then failed) {
    viewer.drawer.post([=, &viewer](OnDevice& on) {
        if (run(viewer, on, *desk, path, *clip, task, failed)) return;
        viewer.work.tell([=, &viewer] { post_paint_task(viewer, desk, path, clip, task, failed); });
    });
}

}  // namespace neuvv::viewer

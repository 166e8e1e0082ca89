// Tasks of the render thread that paint.
#pragma once

#include <filesystem>
#include <functional>

#include "editor/paint/paint_surface.h"
#include "editor/parts.h"

namespace neuvv::editor {

// The field of the file of a clip, or of a segment, of the stage on the device; null where it is still being read.
// Throws InputError where the file is not played any more, or was written again after `clip` was read from it.
std::shared_ptr<const render::Field> field_of(OnDevice& on, const std::filesystem::path& file, const PaintClip& clip);

// Posts a task that runs between two frames, once the field is there, again and again until it returns a function; that
// function then runs on the editor's thread. Where the task throws, a notice tells the user why, and `failed` runs on
// the editor's thread instead.
using PaintTask =
    std::function<JobQueue::Then(PaintSurface& surface, const std::shared_ptr<const render::Field>& field)>;
void post_paint_task(Parts parts, const std::shared_ptr<PaintSurface>& surface, const std::filesystem::path& file,
                     const std::shared_ptr<const PaintClip>& clip, const PaintTask& task, const JobQueue::Then& failed);

}  // namespace neuvv::editor

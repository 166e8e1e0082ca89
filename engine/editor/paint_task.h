// Tasks of the render thread that paint.
#pragma once

#include <filesystem>
#include <functional>

#include "editor/paint_surface.h"
#include "editor/parts.h"

namespace neuvv::editor {

// The field of a clip of the stage on the device. Throws InputError where the clip is no longer on the stage, or where
// its file was written again after `clip` was read.
std::shared_ptr<const render::Field> field_of(OnDevice& on, const std::filesystem::path& path, const PaintClip& clip);

// Posts a task that runs between two frames, again and again until it returns a function; that function then runs on
// the editor's thread. Where the task throws, a notice tells the user why, and `failed` runs on the editor's thread
// instead.
using PaintTask =
    std::function<JobQueue::Then(PaintSurface& surface, const std::shared_ptr<const render::Field>& field)>;
void post_paint_task(Parts parts, const std::shared_ptr<PaintSurface>& surface, const std::filesystem::path& path,
                     const std::shared_ptr<const PaintClip>& clip, const PaintTask& task, const JobQueue::Then& failed);

}  // namespace neuvv::editor

// Painting tasks on the render thread.
#pragma once

#include <filesystem>
#include <functional>

#include "editor/paint_surface.h"
#include "editor/parts.h"

namespace neuvv::editor {

// The clip on the device. Throws InputError where it is gone from the stage, or was written anew since it was read.
std::shared_ptr<const render::Field> field_of(OnDevice& on, const std::filesystem::path& path, const PaintClip& clip);

// Runs between two frames, again and again until the task returns something; that runs on the editor's thread then.
// Where the task throws, the user is told and `failed` runs there instead.
using PaintTask =
    std::function<JobQueue::Then(PaintSurface& surface, const std::shared_ptr<const render::Field>& field)>;
void post_paint_task(Parts parts, std::shared_ptr<PaintSurface> surface, const std::filesystem::path& path,
                     std::shared_ptr<const PaintClip> clip, PaintTask task, JobQueue::Then failed);

}  // namespace neuvv::editor

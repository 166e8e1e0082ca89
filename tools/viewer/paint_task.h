// Inside of painting: work with a desk on the drawer's thread.
#pragma once

#include <filesystem>
#include <functional>

#include "tools/viewer/paint_desk.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

// The clip on the device. Throws InputError where it is gone from the stage, or was written anew since it was read.
std::shared_ptr<const render::Field> field_of(OnDevice& on, const std::filesystem::path& path, const PaintClip& clip);

// Between two pictures, again and again until the task returns something, which runs on the window's thread then. Where
// it cannot be done, that is told and `failed` runs there instead.
using PaintTask = std::function<Work::Then(PaintDesk& desk, const std::shared_ptr<const render::Field>& field)>;
void post_paint_task(Viewer& viewer, std::shared_ptr<PaintDesk> desk, const std::filesystem::path& path,
                     std::shared_ptr<const PaintClip> clip, PaintTask task, Work::Then failed);

}  // namespace neuvv::viewer

// Work that goes on beside the document: its files, an export, a verb of `neuvv`, coaching, and shaders that change.
#pragma once

#include "editor/shader_watch.h"
#include "tools/viewer/coaching.h"
#include "tools/viewer/exporter.h"
#include "tools/viewer/files.h"
#include "tools/viewer/panels/all_panels.h"
#include "tools/viewer/verbs/verb_task.h"

namespace neuvv::viewer {

struct Tasks {
    // `device` is what --device said, for verbs. `shaders` is the folder of sources that is watched; empty: none. All
    // references must outlive this object.
    Tasks(Context& context, Preferences& preferences, Panels& panels, const std::string& device,
          const std::filesystem::path& shaders);
    Tasks(const Tasks&) = delete;
    Tasks& operator=(const Tasks&) = delete;

    // To be called once a frame, with the files that were dropped on the window.
    void tick(Context& context, std::span<const std::filesystem::path> dropped);

    Exporter exporter;
    VerbTask verb;
    Coaching coaching;
    Files files;
    editor::ShaderWatch shader_watch;
};

}  // namespace neuvv::viewer

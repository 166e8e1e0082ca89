// Saves the open document on the job queue, so that the thread of its editor does not wait, and stores unsaved edits
// for recovery.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "editor/autosave.h"

namespace neuvv::editor {

class DocumentSaver {
  public:
    // `editor` and `jobs` must outlive this object, and `jobs` must have been stopped before it is destroyed.
    DocumentSaver(Editor& editor, JobQueue& jobs) : autosave(editor, jobs), editor_(editor), jobs_(jobs) {}

    Autosave autosave;

    // Ends a drag, then writes the document as it is now to `path`. A notice says what became of it, and one before
    // that it waits for another program, which it does for ten seconds. Where it was written, `done` runs on the
    // editor's thread with the document as it is on the disk and with the Editor::open_count() of the time of the call.
    using Done = std::function<void(const edit::Document& saved, uint64_t open_count)>;
    void save(const std::filesystem::path& path, Done done = {});
    bool saving() const { return saving_ > 0; }
    // The path under which the document is saved without asking the user: its own file, or, where it has none yet, a
    // free name beside its clip.
    std::filesystem::path default_path() const;

  private:
    edit::WaitsOn patience();
    Editor& editor_;
    JobQueue& jobs_;
    int saving_ = 0;  // jobs that save
};

// The recovery entries of this stage whose programs no longer run, the latest first.
std::vector<edit::RecoveryEntry> lost_edits_of(const std::filesystem::path& stage);
// The same for the stage that was edited last.
std::vector<edit::RecoveryEntry> lost_edits();

}  // namespace neuvv::editor

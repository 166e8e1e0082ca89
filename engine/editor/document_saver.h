// Saves the open document off its owner's thread, and keeps copies of its unsaved edits for recovery.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "editor/autosave.h"

namespace neuvv::editor {

class DocumentSaver {
  public:
    // Both must outlive it, and `jobs` must have stopped before it goes.
    DocumentSaver(Editor& editor, JobQueue& jobs) : autosave(editor, jobs), editor_(editor), jobs_(jobs) {}

    Autosave autosave;

    // Writes the document as it is now to `path`; a drag ends first. What became of it is told to the user. `done` runs
    // on the owner's thread where it was written, with the document as the disk has it and the number that
    // Editor::opened() had.
    using Done = std::function<void(const edit::Document& saved, uint64_t open_count)>;
    void save(const std::filesystem::path& path, Done done = {});
    bool saving() const { return saving_ > 0; }
    // Where the document would be saved without asking anybody: its file; beside its clip, under a name that is free,
    // where it has none yet.
    std::filesystem::path default_path() const;

  private:
    Editor& editor_;
    JobQueue& jobs_;
    int saving_ = 0;  // jobs
};

// Edits of this stage that a program which no longer runs left behind, the latest first.
std::vector<edit::RecoveryEntry> lost_edits_of(const std::filesystem::path& stage);
// The same of the stage that was edited last, whichever that is.
std::vector<edit::RecoveryEntry> lost_edits();

}  // namespace neuvv::editor

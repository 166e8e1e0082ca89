// Stores the unsaved edits of the open document for recovery every few seconds. The document has one entry in the
// recovery folder, which jobs of the job queue write.
#pragma once

#include <memory>
#include <optional>

#include "base/threads/job_queue.h"
#include "edit/recovery.h"
#include "editor/editor.h"

namespace neuvv::editor {

constexpr double kAutosaveInterval_s = 2;

class Autosave {
  public:
    // `editor` and `jobs` must outlive this object, and `jobs` must have been stopped before it is destroyed. Nothing
    // is stored where there is no recovery folder.
    Autosave(Editor& editor, JobQueue& jobs) : editor_(editor), jobs_(jobs) {}

    // To be called when another document was opened. `recovered` is the entry that it was restored from, if it was;
    // that entry is kept until the new one has been stored.
    void opened(std::optional<edit::RecoveryEntry> recovered = {});
    // To be called once a frame. Starts a job that stores the edits where they changed and kAutosaveInterval_s have
    // passed.
    void tick(double now_s);
    // To be called when the document was saved or closed without saving: its entries are removed, after a job that
    // still stores one.
    void forget();
    // To be called at the end of the program, after `jobs` was stopped: stores the unsaved edits at once. Returns
    // whether there are any.
    bool store_now();

  private:
    Editor& editor_;
    JobQueue& jobs_;
    std::shared_ptr<edit::RecoveryWriter> writer_;  // only jobs use it, one at a time, until store_now()
    std::optional<edit::RecoveryEntry> recovered_;
    bool storing_ = false, failed_ = false;
    uint64_t stored_id_ = 0;
    double stored_s_ = 0;
};

}  // namespace neuvv::editor

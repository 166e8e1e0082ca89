// Stores the unsaved edits of the open document every few seconds for recovery, as one entry, on the job queue.
#pragma once

#include <memory>
#include <optional>

#include "base/job_queue.h"
#include "edit/recovery.h"
#include "editor/editor.h"

namespace neuvv::editor {

constexpr double kAutosaveInterval_s = 2;

class Autosave {
  public:
    // Both must outlive it, and `jobs` must have stopped before it goes. Stores nothing where there is no folder for
    // it.
    Autosave(Editor& editor, JobQueue& jobs) : editor_(editor), jobs_(jobs) {}

    // Another document was opened, `from` these edits, which are kept until its own are stored.
    void opened(std::optional<edit::RecoveryEntry> from = {});
    // Each frame.
    void tick(double now_s);
    // Saved or given up: nothing is kept, once what is being stored has been.
    void forget();
    // At the end, once `jobs` has stopped: all that is unsaved. Whether anything is.
    bool store_now();

  private:
    Editor& editor_;
    JobQueue& jobs_;
    std::shared_ptr<edit::RecoveryWriter> writer_;  // used by jobs alone, one after the other, until the last has gone
    std::optional<edit::RecoveryEntry> from_;
    bool storing_ = false;
    uint64_t stored_id_ = 0;
    double stored_s_ = 0;
};

}  // namespace neuvv::editor

// Unsaved edits of the open document, stored every few seconds for recovery: one entry, on the thread for files.
#pragma once

#include <memory>
#include <optional>

#include "edit/recovery.h"
#include "tools/viewer/editor.h"
#include "tools/viewer/work.h"

namespace neuvv::viewer {

constexpr double kStoreEvery_s = 2;

class StoredEdits {
  public:
    // Both must outlive it, and `work` must have stopped before it goes. Stores nothing where there is no folder for
    // it.
    StoredEdits(Editor& editor, Work& work) : editor_(editor), work_(work) {}

    // Another document was opened, `from` these edits, which are kept until its own are stored.
    void opened(std::optional<edit::RecoveryEntry> from = {});
    // Each frame.
    void tick(double now_s);
    // Saved or given up: nothing is kept, once what is being stored has been.
    void forget();
    // At the end, once `work` has stopped: all that is unsaved. Whether anything is.
    bool store_now();

  private:
    Editor& editor_;
    Work& work_;
    std::shared_ptr<edit::RecoveryWriter> writer_;  // used by jobs alone, one after the other, until the last has gone
    std::optional<edit::RecoveryEntry> from_;
    bool storing_ = false;
    uint64_t stored_id_ = 0;
    double stored_s_ = 0;
};

}  // namespace neuvv::viewer

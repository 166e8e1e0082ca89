// Files of a session in a headset: what is saved, and unsaved edits that outlive a crash, as the viewer's do.
#pragma once

#include "edit/recovery.h"
#include "tools/headset/on_stage.h"
#include "tools/viewer/work.h"

namespace neuvv {

class Keeper {
  public:
    // `recovered`: what the document came from, kept until its edits are stored anew.
    Keeper(OnStage& on, Work& work, std::optional<RecoveryEntry> recovered);

    // Where it has a file, else beside its clip under a name that is free.
    void save();
    bool saving() const { return saving_; }
    // Each frame: unsaved edits are stored now and then.
    void tick(double now_s);
    // At the end, once `work` has stopped: stores what is unsaved. Whether anything is.
    bool store_now();

  private:
    OnStage& on_;
    Work& work_;
    std::shared_ptr<RecoveryWriter> writer_;  // used by jobs alone, one after the other; null: nowhere to store
    std::optional<RecoveryEntry> recovered_;
    bool saving_ = false, storing_ = false;
    uint64_t stored_id_ = 0;
    double stored_s_ = 0;
};

// Edits of this stage that an earlier program left behind, the latest; of none that still runs.
std::optional<RecoveryEntry> lost_edits(const std::filesystem::path& stage);

}  // namespace neuvv

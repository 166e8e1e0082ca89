// Files of a session in a headset: what is saved, and unsaved edits that outlive a crash, as the viewer's do.
#pragma once

#include "tools/headset/on_stage.h"
#include "tools/viewer/stored_edits.h"

namespace neuvv::headset {

class Keeper {
  public:
    // `recovered`: what the document came from, kept until its edits are stored anew.
    Keeper(OnStage& on, viewer::Work& work, std::optional<edit::RecoveryEntry> recovered);

    // Where it has a file, else beside its clip under a name that is free.
    void save();
    bool saving() const { return saving_; }
    // Each frame: unsaved edits are stored now and then.
    void tick(double now_s) { stored_.tick(now_s); }
    // At the end, once `work` has stopped: stores what is unsaved. Whether anything is.
    bool store_now() { return stored_.store_now(); }

  private:
    OnStage& on_;
    viewer::Work& work_;
    viewer::StoredEdits stored_;
    bool saving_ = false;
};

// Edits of this stage that an earlier program left behind, the latest; of none that still runs.
std::optional<edit::RecoveryEntry> lost_edits(const std::filesystem::path& stage);

}  // namespace neuvv::headset

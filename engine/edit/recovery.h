// Unsaved edits that survive a crash: what a document has beyond the disk, in a folder of entries, one a document and
// process. An entry is a folder: entry.json (whose stage, when, the document's JSON), the layers of paint that are not
// saved, and a lock that its process holds while it lives.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/file_lock.h"
#include "edit/edited_stage.h"

namespace neuvv::edit {

// The folder for entries of this user (state_folder()/recovery); empty where there is none.
std::filesystem::path recovery_folder();

// Keeps the entry of one document. Its calls come from one thread at a time, any one, with copies of the document.
class RecoveryWriter {
  public:
    // Entries go to this folder, which is made with the first.
    explicit RecoveryWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // The entry says what the document is now; atomically. Layers and documents that are as they were stored last are
    // not written again. Throws RuntimeFailure where the disk fails; the entry is as it was then.
    void store(const Document& document);
    // There is nothing to recover: the document is saved, or given up. Without it the entry outlives this object.
    void discard();

  private:
    struct StoredLayer {
        std::shared_ptr<const voctree::EditLayer> layer;
        std::string file;
    };
    using StoredLayers = std::map<std::filesystem::path, StoredLayer>;
    void make_entry();
    StoredLayers store_layers(const Document& document);
    void remove_layers_but(const StoredLayers& kept);

    std::filesystem::path folder_, entry_;  // entry_ is empty while there is none
    FileLock lock_;
    uint64_t next_layer_ = 0;
    // As stored last.
    stage::StageFile file_;
    uint64_t disk_hash_ = 0;  // of file_.saved
    StoredLayers layers_;
};

struct RecoveryEntry {
    std::filesystem::path folder;  // the entry's own
    std::filesystem::path stage;   // absolute; where a new one would have been, if it was never saved
    int64_t when_s = 0;            // since 1970, UTC
    int64_t process = 0;
    bool alive = false;    // the process that wrote it holds it still
    bool on_disk = false;  // the stage had been saved before
    bool changed = false;  // the stage's file is another now than that which was edited, or gone
};

// Whether the disk has another program's version of a stage that had been saved: which saving keeps beside it.
bool has_foreign_file(const RecoveryEntry& entry);

// All entries, the latest first; what is damaged is left out. No folder, no entries.
std::vector<RecoveryEntry> list_recovery(const std::filesystem::path& folder);
// The same of one stage.
std::vector<RecoveryEntry> find_recovery(const std::filesystem::path& folder, const std::filesystem::path& stage);

// The document as it was stored, beside what the disk holds now (a History of it begins with mark_unsaved). Throws
// InputError for damaged entries, for documents that could not be saved, and where a .glb is gone whose buffers the
// document needs.
Document restore(const RecoveryEntry& entry);

// Removes the entry.
void discard(const RecoveryEntry& entry);

}  // namespace neuvv::edit

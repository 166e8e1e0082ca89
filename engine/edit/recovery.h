// Unsaved edits that survive a crash: what a document has beyond the disk. They are kept in a folder of entries, one
// entry for each document and process. An entry is a folder with entry.json (the stage's path, the time, the document's
// JSON), the layers of paint that are not saved, and a lock that its process holds until it ends.
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

// The folder for the entries of this user (state_folder()/recovery); empty where there is none.
std::filesystem::path recovery_folder();

// Writes the entry of one document. Calls may come from any thread, but only one at a time.
class RecoveryWriter {
  public:
    // Entries are written to this folder, which is created with the first one.
    explicit RecoveryWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // Writes the document as it is now to its entry, atomically. Layers and documents that have not changed since the
    // last call are not written again. Throws RuntimeFailure where the disk fails; the entry then stays as it was.
    void store(const Document& document);
    // Removes the entry, because the document was saved or closed. Without this call the entry outlives this object.
    void discard();

  private:
    struct StoredLayer {
        std::shared_ptr<const voctree::EditLayer> layer, saved;  // saved: as the disk has it; null for a new one
        std::string file;
        bool operator==(const StoredLayer&) const = default;
    };
    using StoredLayers = std::map<std::filesystem::path, StoredLayer>;
    void make_entry();
    StoredLayers store_layers(const Document& document);
    void remove_layers_but(const StoredLayers& kept);

    std::filesystem::path folder_, entry_;  // entry_ is empty while there is no entry
    FileLock lock_;
    uint64_t next_layer_ = 0;
    // What the entry contains.
    stage::StageFile file_;
    uint64_t disk_hash_ = 0;  // of the bytes of file_.saved
    StoredLayers layers_;
};

struct RecoveryEntry {
    std::filesystem::path folder;  // of the entry
    std::filesystem::path stage;   // absolute; for a stage that was never saved, the path that it was to get
    int64_t when_s = 0;            // seconds since 1970, UTC
    int64_t process = 0;
    bool alive = false;    // the process that wrote it still runs
    bool on_disk = false;  // the stage had been saved before
    bool changed = false;  // whether the stage's file is not the one that was edited: changed, removed or new
};

// Whether the disk has another program's version of a stage that had been saved. Saving keeps that version beside the
// stage.
bool has_foreign_file(const RecoveryEntry& entry);

// All entries of a folder, the latest first. Damaged entries are left out. A folder that does not exist has no entries.
std::vector<RecoveryEntry> list_recovery(const std::filesystem::path& folder);
// The entries of one stage.
std::vector<RecoveryEntry> find_recovery(const std::filesystem::path& folder, const std::filesystem::path& stage);

// The document as it was stored, with the disk's present version as its saved state; a History of it should begin with
// mark_unsaved. A layer that another program has painted since has no saved state, so that saving keeps that version.
// Throws InputError for damaged entries, for documents that could not be saved, and where a .glb is
// missing whose buffers the document needs.
Document restore(const RecoveryEntry& entry);

// Removes the entry.
void discard(const RecoveryEntry& entry);

}  // namespace neuvv::edit

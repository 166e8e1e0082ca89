// Opening another stage, clip or address in place of the document, without leaving the headset: a job reads the
// document, a thread its clips, and meanwhile the present stage goes on.
#pragma once

#include <filesystem>
#include <vector>

#include "base/threads/job_queue.h"
#include "tools/headset/state/headset_state.h"

namespace neuvv::headset {

// What the panel lists of a folder: folders first, those that are clips excepted, then stages and clips, by name.
struct FolderEntry {
    std::filesystem::path path;
    bool is_folder = false;
};
constexpr size_t kMaxEntries = 200;
std::vector<FolderEntry> entries_of(const std::filesystem::path& folder);

// Begins to open a file or an address. Where the document has unsaved edits or something else is being read, a notice
// says so instead; where it cannot be opened, a notice says why, and the document stays.
void open_other(HeadsetState& state, JobQueue& jobs, const std::filesystem::path& path);

}  // namespace neuvv::headset

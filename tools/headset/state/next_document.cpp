#include "tools/headset/state/next_document.h"

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "editor/open_file.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_index.h"

namespace neuvv::headset {

std::vector<FolderEntry> entries_of(const std::filesystem::path& folder) {
    std::vector<FolderEntry> entries;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::filesystem::path& path = entry->path();
        std::error_code of_entry;
        const bool is_hidden = path.filename().string().starts_with('.');
        const bool is_clip = voctree::has_clip_ending(path);
        const bool is_folder = entry->is_directory(of_entry) && !(is_clip && voctree::is_segmented(path));
        const bool may_open = is_folder || is_clip || editor::has_stage_ending(path);
        if (may_open && !is_hidden) entries.push_back({path, is_folder});
    }
    std::ranges::sort(entries, [](const FolderEntry& a, const FolderEntry& b) {
        return a.is_folder != b.is_folder ? a.is_folder : a.path < b.path;
    });
    if (entries.size() > kMaxEntries) entries.resize(kMaxEntries);
    return entries;
}

void open_other(HeadsetState& state, JobQueue& jobs, const std::filesystem::path& path) {
    if (state.editor.modified())
        return state.editor.notify("not saved: save the stage, or undo its edits, before another one is opened", true);
    if (state.next_document) return state.editor.notify("another one is being read", true);
    state.next_document.emplace();
    state.next_document->path = path;
    jobs.start("", [&state, path]() -> JobQueue::Then {
        try {
            edit::Document document = editor::open_document(path);
            stage::make_stage(document.file);  // says what is wrong with it while the present one is still there
            return [&state, document = std::move(document)] {
                if (state.next_document) state.next_document->document = document;
            };
        } catch (const InputError& error) {
            return [&state, text = std::string(error.what())] {
                state.editor.notify(text, true);
                state.next_document.reset();
            };
        }
    });
}

}  // namespace neuvv::headset

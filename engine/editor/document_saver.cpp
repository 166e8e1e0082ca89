#include "editor/document_saver.h"

#include <fmt/format.h>

#include <memory>
#include <set>

#include "edit/paint_layers.h"

namespace neuvv::editor {

namespace {

// Says which layers of paint the stage at the old path uses, too, where the document is saved to another path: saving
// changes those layers for both stages. Empty: none.
std::string also_changed(const edit::Document& document, const std::filesystem::path& path) {
    if (!document.file.saved->on_disk || stage::absolute_path(path) == stage::absolute_path(document.file.path))
        return {};
    std::set<std::string> names;  // of layers: of a clip in segments, that of the folder
    const std::set<std::filesystem::path> used = edit::used_layers(document.file);
    for (const auto& [file, layer] : document.saved_paint)
        if (const auto now = document.paint.find(file); now != document.paint.end() && now->second != layer)
            names.insert((used.contains(file.parent_path()) ? file.parent_path() : file).filename().string());
    std::string text;
    for (const std::string& name : names)
        text += fmt::format("; {} uses the same {}", document.file.path.filename().string(), name);
    return text;
}

constexpr int kMostWait_s = 10;

}  // namespace

// Says once what is waited for. Other jobs wait meanwhile, so this one gives up after a while.
edit::WaitsOn DocumentSaver::patience() {
    return [this, waited_s = 0](const std::filesystem::path& file) mutable {
        if (++waited_s == 1)
            jobs_.post([this, name = file.filename().string()] {
                editor_.notify(fmt::format("another program is editing {}: the save waits for it", name));
            });
        return waited_s < kMostWait_s;
    };
}

void DocumentSaver::save(const std::filesystem::path& path, Done done) {
    editor_.end_drag();
    ++saving_;
    auto document = std::make_shared<edit::Document>(editor_.document());
    jobs_.start(fmt::format("Saving {}", path.filename().string()),
                [this, document, path, id = editor_.id(), open_count = editor_.open_count(),
                 also = also_changed(*document, path), done = std::move(done)]() -> JobQueue::Then {
                    std::string problem;
                    std::vector<edit::KeptVersion> kept;
                    try {
                        kept = edit::save_document(*document, path, patience());
                    } catch (const std::exception& error) {
                        problem = error.what();
                    }
                    return [=, this] {
                        --saving_;
                        if (!problem.empty()) return editor_.notify(problem, true);
                        editor_.saved(*document, open_count, id);
                        if (!editor_.modified()) autosave.forget();
                        editor_.notify(edit::saved_text(path, kept) + also);
                        if (done) done(*document, open_count);
                    };
                });
}

std::filesystem::path DocumentSaver::default_path() const {
    const stage::StageFile& file = editor_.file();
    return file.saved->on_disk ? file.path : edit::free_path(file.path);
}

std::vector<edit::RecoveryEntry> lost_edits_of(const std::filesystem::path& stage) {
    if (edit::recovery_folder().empty()) return {};
    std::vector<edit::RecoveryEntry> entries = edit::find_recovery(edit::recovery_folder(), stage);
    std::erase_if(entries, [](const edit::RecoveryEntry& entry) { return entry.alive; });
    return entries;
}

std::vector<edit::RecoveryEntry> lost_edits() {
    if (edit::recovery_folder().empty()) return {};
    std::vector<edit::RecoveryEntry> entries = edit::list_recovery(edit::recovery_folder());
    std::erase_if(entries, [](const edit::RecoveryEntry& entry) { return entry.alive; });
    if (!entries.empty())
        std::erase_if(entries, [stage = entries.front().stage](const auto& entry) { return entry.stage != stage; });
    return entries;
}

}  // namespace neuvv::editor

#include "tools/headset/keeper.h"

namespace neuvv::headset {

std::optional<edit::RecoveryEntry> lost_edits(const std::filesystem::path& stage) {
    if (edit::recovery_folder().empty()) return std::nullopt;
    for (edit::RecoveryEntry& entry : edit::find_recovery(edit::recovery_folder(), stage))
        if (!entry.alive) return std::move(entry);
    return std::nullopt;
}

Keeper::Keeper(OnStage& on, viewer::Work& work, std::optional<edit::RecoveryEntry> recovered)
    : on_(on), work_(work), stored_(on.editor, work) {
    stored_.opened(std::move(recovered));
}

void Keeper::save() {
    if (saving_) return;
    on_.editor.end_drag();
    saving_ = true;
    auto document = std::make_shared<edit::Document>(on_.editor.document());
    const std::filesystem::path path =
        document->file.saved->on_disk ? document->file.path : edit::free_path(document->file.path);
    work_.start("Saving",
                [this, document, path, id = on_.editor.id(), opened = on_.editor.opened()]() -> viewer::Work::Then {
                    std::string problem;
                    std::optional<std::filesystem::path> theirs;
                    try {
                        theirs = edit::save_document(*document, path);
                    } catch (const std::exception& error) {
                        problem = error.what();
                    }
                    return [this, document, path, id, opened, problem, theirs] {
                        saving_ = false;
                        if (!problem.empty()) return on_.editor.tell(problem, true);
                        on_.editor.saved(*document, opened, id);
                        on_.editor.tell(edit::saved_text(path, theirs));
                    };
                });
}

}  // namespace neuvv::headset

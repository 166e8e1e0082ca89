#include "tools/headset/keeper.h"

#include <fmt/format.h>

namespace neuvv {

namespace {

constexpr double kStoreEvery_s = 2;

// "stage.gltf", "stage-2.gltf".
std::filesystem::path free_path(const std::filesystem::path& wanted) {
    std::filesystem::path path = wanted;
    for (int number = 2; std::filesystem::exists(path); number++)
        path =
            wanted.parent_path() / fmt::format("{}-{}{}", wanted.stem().string(), number, wanted.extension().string());
    return path;
}

}  // namespace

std::optional<RecoveryEntry> lost_edits(const std::filesystem::path& stage) {
    if (recovery_folder().empty()) return std::nullopt;
    for (RecoveryEntry& entry : find_recovery(recovery_folder(), stage))
        if (!entry.alive) return std::move(entry);
    return std::nullopt;
}

Keeper::Keeper(OnStage& on, Work& work, std::optional<RecoveryEntry> recovered)
    : on_(on), work_(work), recovered_(std::move(recovered)) {
    if (!recovery_folder().empty()) writer_ = std::make_shared<RecoveryWriter>(recovery_folder());
    stored_id_ = recovered_ ? 0 : on.editor.id();
}

void Keeper::save() {
    if (saving_) return;
    on_.editor.end_drag();
    saving_ = true;
    auto document = std::make_shared<Document>(on_.editor.document());
    const std::filesystem::path path =
        document->file.saved->on_disk ? document->file.path : free_path(document->file.path);
    work_.start("Saving", [this, document, path, id = on_.editor.id(), opened = on_.editor.opened()]() -> Work::Then {
        std::string problem;
        try {
            save_document(*document, path);
        } catch (const std::exception& error) {
            problem = error.what();
        }
        return [this, document, path, id, opened, problem] {
            saving_ = false;
            if (!problem.empty()) return on_.editor.tell(problem, true);
            on_.editor.saved(*document, opened, id);
            on_.editor.tell(fmt::format("saved {}", path.string()));
        };
    });
}

void Keeper::tick(double now_s) {
    if (!writer_ || storing_ || on_.editor.id() == stored_id_ || now_s - stored_s_ < kStoreEvery_s) return;
    stored_s_ = now_s;
    storing_ = true;
    const bool modified = on_.editor.modified() || on_.editor.dragging();
    work_.start("",
                [this, modified, id = on_.editor.id(), writer = writer_, from = recovered_,
                 document = std::make_shared<Document>(on_.editor.document())]() -> Work::Then {
                    std::string problem;
                    try {
                        if (modified)
                            writer->store(*document);
                        else
                            writer->discard();
                        if (from) discard(*from);
                    } catch (const std::exception& error) {
                        problem = error.what();
                    }
                    return [this, id, problem] {
                        storing_ = false;
                        recovered_.reset();
                        stored_id_ = id;
                        if (!problem.empty())
                            on_.editor.tell("unsaved edits cannot be kept for recovery: " + problem, true);
                    };
                });
}

bool Keeper::store_now() {
    on_.editor.end_drag();
    if (!writer_) return on_.editor.modified();
    if (on_.editor.modified())
        writer_->store(on_.editor.document());
    else
        writer_->discard();
    if (recovered_) discard(*recovered_);
    return on_.editor.modified();
}

}  // namespace neuvv

#include "editor/autosave.h"

#include <utility>

namespace neuvv::editor {

void Autosave::opened(std::optional<edit::RecoveryEntry> recovered) {
    writer_ =
        edit::recovery_folder().empty() ? nullptr : std::make_shared<edit::RecoveryWriter>(edit::recovery_folder());
    stored_id_ = 0;
    failed_ = false;
    recovered_ = std::move(recovered);
}

// At most one job stores at a time, and it works on a copy of the document.
void Autosave::tick(double now_s) {
    if (now_s - stored_s_ < kAutosaveInterval_s) return;
    if (!writer_ || storing_ || !editor_.is_open() || editor_.id() == stored_id_) return;
    stored_s_ = now_s;
    storing_ = true;
    const bool modified = editor_.modified() || editor_.dragging();
    jobs_.start("",
                [this, modified, id = editor_.id(), document = std::make_shared<edit::Document>(editor_.document()),
                 writer = writer_, recovered = recovered_]() -> JobQueue::Then {
                    std::string problem;
                    try {
                        if (modified)
                            writer->store(*document);
                        else
                            writer->discard();
                        if (recovered) edit::discard(*recovered);
                    } catch (const std::exception& error) {
                        problem = error.what();
                    }
                    return [this, writer, id, problem] {
                        storing_ = false;
                        if (writer != writer_) return;  // another document was opened since
                        const bool failed_before = std::exchange(failed_, !problem.empty());
                        if (failed_) {  // the next tick tries again; it is said once
                            if (!failed_before)
                                editor_.notify("unsaved edits cannot be kept for recovery: " + problem, true);
                            return;
                        }
                        recovered_.reset();
                        stored_id_ = id;
                        if (failed_before) editor_.notify("unsaved edits are kept for recovery again");
                    };
                });
}

void Autosave::forget() {
    if (!writer_) return;
    jobs_.start("", [writer = writer_, recovered = std::exchange(recovered_, std::nullopt)]() -> JobQueue::Then {
        writer->discard();
        if (recovered) edit::discard(*recovered);
        return {};
    });
}

bool Autosave::store_now() {
    editor_.end_drag();
    if (!writer_) return editor_.modified();
    if (editor_.modified())
        writer_->store(editor_.document());
    else
        writer_->discard();
    if (recovered_) edit::discard(*recovered_);
    return editor_.modified();
}

}  // namespace neuvv::editor

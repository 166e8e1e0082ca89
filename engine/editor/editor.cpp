#include "editor/editor.h"

#include <fmt/format.h>

#include <utility>

#include "base/error.h"
#include "edit/read.h"
#include "stage/stage.h"

namespace neuvv::editor {

void Editor::open(edit::Document document, bool modified) {
    document_ = std::move(document);
    history_ = edit::History();
    if (modified) history_.mark_unsaved();
    selected_.reset();
    before_drag_.reset();
    open_ = true;
    ++open_count_;
    changed();
    unreported_from_ = id_;
}

void Editor::stage_made(const stage::Stage& stage, uint64_t id) {
    if (!unreported_from_ || id < *unreported_from_) return;
    unreported_from_.reset();
    for (const std::string& note : stage.scene.notes)
        notify(fmt::format("{} {}", stage.file.path.filename().string(), note));
}

void Editor::saved(const edit::Document& as, uint64_t open_count, uint64_t id) {
    if (open_count != open_count_) return;
    const auto follow = [&](edit::Document& document) {
        document.file = stage::moved_to(std::move(document.file), as.file.path);
        document.file.saved = as.file.saved;
        document.disk_is_foreign = false;
        for (const auto& [path, layer] : as.saved_paint) document.saved_paint[path] = layer;
    };
    follow(document_);
    if (before_drag_) follow(*before_drag_);
    if (id == id_) {
        document_.file = as.file;
        history_.mark_saved();
    }
    changed();
}

bool Editor::apply(const Operation& operation, std::string& what) {
    edit::Document before = document_;
    try {
        what = operation(document_);
    } catch (const InputError& error) {
        document_ = std::move(before);
        notify(error.what(), true);
        return false;
    }
    return true;
}

bool Editor::refused() {
    if (frozen_.empty()) return false;
    if (notices_.empty()) notify(frozen_, true);
    return true;
}

bool Editor::edit(const Operation& operation) {
    if (refused()) return false;
    end_drag();
    edit::Document before = document_;
    std::string what;
    if (!apply(operation, what)) return false;
    if (edit::same_document(before, document_)) return true;
    history_.add_step(std::move(before), document_, std::move(what), selected_);
    changed();
    return true;
}

bool Editor::drag(const Operation& operation) {
    if (refused()) return false;
    edit::Document last = document_;
    if (before_drag_) document_ = *before_drag_;
    if (!apply(operation, dragged_)) {
        document_ = std::move(last);
        return false;
    }
    if (!before_drag_) {
        before_drag_ = std::move(last);
        selected_before_drag_ = selected_;
    }
    changed();
    return true;
}

void Editor::end_drag() {
    if (!before_drag_) return;
    if (edit::same_document(*before_drag_, document_)) return cancel_drag();
    history_.add_step(std::move(*before_drag_), document_, std::exchange(dragged_, {}), selected_before_drag_);
    before_drag_.reset();
    changed();
}

void Editor::cancel_drag() {
    if (!before_drag_) return;
    document_ = std::move(*before_drag_);
    before_drag_.reset();
    changed();
}

void Editor::take_back(const std::string& why) {
    notify(why, true);
    if (before_drag_) return cancel_drag();
    if (history_.next_undo()) undo();
}

void Editor::undo() {
    if (refused()) return;
    end_drag();
    step("undone", &edit::History::undo);
}

void Editor::redo() {
    if (refused()) return;
    end_drag();
    step("done again", &edit::History::redo);
}

void Editor::step(const char* verb, Take take) {
    const stage::StageFile before = document_.file;
    std::optional<uint32_t> then = selected_;
    try {
        const std::optional<std::string> what = (history_.*take)(document_, &then);
        if (!what) return;
        notify(std::string(verb) + ": " + *what);
    } catch (const InputError& error) {
        return notify(error.what(), true);
    }
    if (node_count() != edit::node_count(before) &&
        !(selected_ && edit::same_nodes(before, document_.file, size_t{*selected_} + 1)))
        selected_ = then;
    changed();
}

// A drag is applied to the document as it was when the drag began, so the layer is added there, too.
void Editor::open_layer(const std::filesystem::path& path, const std::shared_ptr<const voctree::EditLayer>& layer) {
    for (edit::Document* document : {&document_, before_drag_ ? &*before_drag_ : nullptr})
        if (document && document->paint.emplace(path, layer).second) document->saved_paint.emplace(path, layer);
}

size_t Editor::node_count() const {
    return edit::node_count(document_.file);
}

void Editor::changed() {
    ++id_;
    if (selected_ && *selected_ >= node_count()) selected_.reset();
}

std::vector<Notice> Editor::take_notices() {
    return std::exchange(notices_, {});
}

void Editor::notify(std::string text, bool error) {
    if (!notices_.empty() && notices_.back().text == text) return;
    notices_.push_back({std::move(text), error});
}

}  // namespace neuvv::editor

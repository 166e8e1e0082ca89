// Undo and redo: the document as it was before and after each edit of the stage or of paint. Steps share the layers and
// the members of the JSON that they did not change: a stroke costs one layer, and moving a node costs the list of
// nodes.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "edit/edited_stage.h"

namespace neuvv::edit {

class History {
  public:
    // Keeps at most so many steps, and so many bytes of JSON and layers that the document itself does not use
    // (extra_bytes). The oldest steps are dropped, but never the last one.
    explicit History(size_t steps = 100, uint64_t bytes = uint64_t{512} << 20)
        : step_limit_(steps), byte_limit_(bytes) {}

    // Adds a step after an edit: the document before and after it, and what the edit did. Steps that were undone can no
    // longer be redone. `selected` is the node that was selected before the edit.
    void add_step(Document before, const Document& after, std::string what, std::optional<uint32_t> selected = {});

    // Takes JSON and paint one step back or forward. Returns what the step did, nullopt where there is no step. The
    // document keeps its path and its saved state. Where it was saved into another folder since the step, the URIs are
    // adapted (moved_to, which may throw InputError: then nothing has changed). `selected`, where it is given, is the
    // selected node, and becomes the one that was selected when the document was like that.
    std::optional<std::string> undo(Document& document, std::optional<uint32_t>* selected = nullptr);
    std::optional<std::string> redo(Document& document, std::optional<uint32_t>* selected = nullptr);
    // What undo or redo would do, for menus; null where there is no step.
    const std::string* next_undo() const { return undo_.empty() ? nullptr : &undo_.back().what; }
    const std::string* next_redo() const { return redo_.empty() ? nullptr : &redo_.back().what; }

    // The bytes that the steps use beyond the document. A value that several steps share counts once.
    uint64_t extra_bytes(const Document& document) const;

    // The number of the document's state: the same number means the same state.
    uint64_t revision() const { return revision_; }
    // To be called when the disk has the document as it is now, or when the disk has none of the states of this history
    // (for a recovered document).
    void mark_saved() { saved_ = revision_; }
    void mark_unsaved() { saved_ = 0; }
    bool is_modified() const { return revision_ != saved_; }

  private:
    // The state before the step in `undo_`, after the step in `redo_`.
    struct Step {
        std::filesystem::path path;  // of the document: URIs are relative to its folder
        stage::StageJson json;
        PaintLayers paint;
        uint64_t revision = 0;
        std::string what;
        std::optional<uint32_t> selected;
    };
    static std::optional<std::string> step(Document& document, uint64_t& revision, std::optional<uint32_t>* selected,
                                           std::deque<Step>& from, std::deque<Step>& to);

    size_t step_limit_;
    uint64_t byte_limit_;
    std::deque<Step> undo_, redo_;
    uint64_t revision_ = 1, last_revision_ = 1, saved_ = 1;
};

}  // namespace neuvv::edit

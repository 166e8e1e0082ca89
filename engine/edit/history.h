// Undo and redo: the document as it was before and after each edit, of the stage or of paint. Steps share the layers
// and the members of the JSON that they did not change, so a stroke costs one layer, and moving a node the list of
// nodes.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "edit/edited_stage.h"

namespace neuvv::edit {

class History {
  public:
    // Keeps so many steps, and so many bytes of JSON and layers that the document itself does not hold; the oldest
    // steps are forgotten, the last one never.
    explicit History(size_t steps = 100, uint64_t bytes = uint64_t{512} << 20)
        : step_limit_(steps), byte_limit_(bytes) {}

    // After an edit: the document as it was before it, as it is, and what the edit said. What was undone cannot be
    // redone then.
    void add_step(Document before, const Document& after, std::string what);

    // Puts JSON and paint back by a step, or forward again; what the step was, nothing where there is none. The
    // document keeps its path and what was saved; where it was saved into another folder since, URIs follow (moved_to,
    // which may throw: then nothing has changed).
    std::optional<std::string> undo(Document& document);
    std::optional<std::string> redo(Document& document);
    // What they would take back or do again, for menus; null where there is nothing.
    const std::string* next_undo() const { return undo_.empty() ? nullptr : &undo_.back().what; }
    const std::string* next_redo() const { return redo_.empty() ? nullptr : &redo_.back().what; }

    // What the steps hold beyond the document, each value that several of them share once.
    uint64_t extra_bytes(const Document& document) const;

    // Numbers the states that the document has been in: the same number, the same state.
    uint64_t revision() const { return revision_; }
    // The disk has the document as it is, or has it in no state of this history (a recovered one).
    void mark_saved() { saved_ = revision_; }
    void mark_unsaved() { saved_ = 0; }
    bool is_modified() const { return revision_ != saved_; }

  private:
    // A state before the step where it can be undone, after it where it can be redone.
    struct Step {
        std::filesystem::path path;  // from which the URIs go
        stage::StageJson json;
        PaintLayers paint;
        uint64_t revision = 0;
        std::string what;
    };
    static std::optional<std::string> step(Document& document, uint64_t& revision, std::deque<Step>& from,
                                           std::deque<Step>& to);

    size_t step_limit_;
    uint64_t byte_limit_;
    std::deque<Step> undo_, redo_;
    uint64_t revision_ = 1, last_revision_ = 1, saved_ = 1;
};

}  // namespace neuvv::edit

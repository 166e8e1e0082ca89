// The document session: the stage that is open, its edits and their history, a drag, the selection, and notices for the
// user. Faces change the document through it; the render thread shows what it holds.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "edit/edited_stage.h"
#include "edit/history.h"

namespace neuvv::editor {

// A line for the user, to be shown for some seconds.
struct Notice {
    std::string text;
    bool error = false;
    double until_s = 0;  // of the face's clock
};

class Editor {
  public:
    // An operation on the document, which says what it did (edit/operations.h). Throws InputError where it cannot be
    // done. Whether the numbers it was given are sound is found by the render thread: then call take_back().
    using Operation = std::function<std::string(edit::Document&)>;

    void open(edit::Document document, bool modified);
    bool is_open() const { return open_; }
    size_t node_count() const;
    const edit::Document& document() const { return document_; }
    const stage::StageFile& file() const { return document_.file; }
    // It changes with each change of the document.
    uint64_t id() const { return id_; }
    bool modified() const { return open_ && history_.is_modified(); }
    // It changes with each open().
    uint64_t open_count() const { return open_count_; }
    // The disk has the document as it was with this id, as saving left it. What was edited since stays, and follows it
    // to its folder; a document that was opened since has nothing to do with it.
    void saved(const edit::Document& as, uint64_t open_count, uint64_t id);

    // While the reason is not empty nothing can be edited, and the user is told the reason instead.
    void freeze(std::string reason) { frozen_ = std::move(reason); }

    // False where it could not be done: a notice says why, and all is as before.
    bool edit(const Operation& operation);
    // An edit that is still going on, a drag for instance: each operation is applied to the document as it was before
    // the first; end_drag() makes them one step of the history. Nothing else is edited meanwhile.
    bool drag(const Operation& operation);
    void end_drag();
    void cancel_drag();
    bool dragging() const { return before_drag_.has_value(); }
    // The last step made a document that cannot be drawn: it is undone, and `why` told.
    void take_back(const std::string& why);
    void undo();
    void redo();
    const edit::History& history() const { return history_; }

    // Before the first edit of a layer of paint: as the disk has it (open_paint). No step of the history; of a layer
    // that is open nothing.
    void open_layer(const std::filesystem::path& path, const std::shared_ptr<const voctree::EditLayer>& layer);

    // A node of the document; none where nothing is selected.
    std::optional<uint32_t> selected() const { return selected_; }
    void select(std::optional<uint32_t> node) { selected_ = node; }

    // The notices since the last call.
    std::vector<Notice> take_notices();
    void notify(std::string text, bool error = false);

  private:
    bool refused();
    bool apply(const Operation& operation, std::string& what);
    void changed();
    void step(const char* verb, const std::function<std::optional<std::string>()>& take);
    bool open_ = false;
    std::string frozen_;
    edit::Document document_;
    edit::History history_;
    uint64_t id_ = 0, open_count_ = 0;
    std::optional<uint32_t> selected_;
    std::optional<edit::Document> before_drag_;
    std::string dragged_;
    std::vector<Notice> notices_;
};

}  // namespace neuvv::editor

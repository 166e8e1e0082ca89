// The document session: the open stage, its edits and their history, the drag state, the selection, and notices for the
// user. The viewer and the headset change the document through an Editor, and the render thread draws its document.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "edit/edited_stage.h"
#include "edit/history.h"

namespace neuvv::stage {
struct Stage;
}

namespace neuvv::editor {

// A line of text for the user, displayed for some seconds.
struct Notice {
    std::string text;
    bool error = false;
    double until_s = 0;  // on the clock of the program that displays it
};

class Editor {
  public:
    // An operation on the document. It returns a line that says what it did (edit/operations.h), and throws InputError
    // where it cannot be done. Whether the numbers that it wrote can be drawn is checked later, when the render thread
    // loads the document; where they cannot, the program calls take_back().
    using Operation = std::function<std::string(edit::Document&)>;

    void open(edit::Document document, bool modified);
    bool is_open() const { return open_; }
    size_t node_count() const;
    const edit::Document& document() const { return document_; }
    const stage::StageFile& file() const { return document_.file; }
    // Changes with each change of the document.
    uint64_t id() const { return id_; }
    bool modified() const { return open_ && history_.is_modified(); }
    // How many documents have been opened: it identifies the open one.
    uint64_t open_count() const { return open_count_; }
    // To be called when `as` was written to the disk: the document that was open when open_count() and id() had these
    // values. Later edits stay unsaved, and the document moves to the folder of `as`. Nothing happens where another
    // document has been opened since.
    void saved(const edit::Document& as, uint64_t open_count, uint64_t id);

    // To be called with each stage that was made of the document with this id(). After the first one of a document that
    // was opened, notices tell what of its file is not shown (GltfScene::notes).
    void stage_made(const stage::Stage& stage, uint64_t id);

    // While `reason` is not empty, every edit is refused, and a notice tells the user the reason.
    void freeze(std::string reason) { frozen_ = std::move(reason); }

    // Applies the operation and adds a step to the history. Where it cannot be done, returns false, adds a notice with
    // the reason, and leaves the document as it was.
    bool edit(const Operation& operation);
    // Previews an edit that is still going on. Each operation is applied to the document as it was before the first
    // call; end_drag() makes the last result one step of the history. Returns false as edit() does. Other edits end
    // the drag first.
    bool drag(const Operation& operation);
    void end_drag();
    void cancel_drag();
    bool dragging() const { return before_drag_.has_value(); }
    // Undoes the last step, or the drag, because the document that it made cannot be drawn; a notice says `why`.
    void take_back(const std::string& why);
    // Afterwards the node stays selected, unless its number may mean another one now. Then, and where nodes came back
    // and none is selected, that is selected which was when the document was like that.
    void undo();
    void redo();
    const edit::History& history() const { return history_; }

    // To be called before the first edit of a layer of paint, with the layer as the disk has it (open_paint). This is
    // no step of the history. Nothing happens where the layer is open already.
    void open_layer(const std::filesystem::path& path, const std::shared_ptr<const voctree::EditLayer>& layer);

    // The selected node of the document; nullopt: none.
    std::optional<uint32_t> selected() const { return selected_; }
    void select(std::optional<uint32_t> node) { selected_ = node; }

    // Returns the notices since the last call.
    std::vector<Notice> take_notices();
    void notify(std::string text, bool error = false);

  private:
    bool refused();
    bool apply(const Operation& operation, std::string& what);
    void changed();
    using Take = std::optional<std::string> (edit::History::*)(edit::Document&, std::optional<uint32_t>*);
    void step(const char* verb, Take take);
    bool open_ = false;
    std::string frozen_;
    edit::Document document_;
    edit::History history_;
    uint64_t id_ = 0, open_count_ = 0;
    std::optional<uint64_t> unreported_from_;  // id() of the opened document, until stage_made has reported it
    std::optional<uint32_t> selected_;
    std::optional<edit::Document> before_drag_;
    std::optional<uint32_t> selected_before_drag_;
    std::string dragged_;
    std::vector<Notice> notices_;
};

}  // namespace neuvv::editor

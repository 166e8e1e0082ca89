// Undo and redo of a layer of paint: what a tool took out of it and put into it, not copies of the whole.
#pragma once

#include "voctree/paint.h"

namespace neuvv {

class PaintHistory {
  public:
    // The layer is as it was at the last call, and becomes `after`: one step, which undo takes back.
    void change(EditLayer& layer, std::vector<LeafEdit> after);
    // False where there is nothing to take back or to do again.
    bool undo(EditLayer& layer);
    bool redo(EditLayer& layer);
    size_t undo_steps() const { return done_.size(); }
    size_t redo_steps() const { return undone_.size(); }

  private:
    struct Change {
        std::vector<LeafEdit> removed, added;  // in a layer's order
    };
    static void apply(EditLayer& layer, const Change& change);
    std::vector<Change> done_, undone_;
};

}  // namespace neuvv

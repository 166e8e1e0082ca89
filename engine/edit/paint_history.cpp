#include "edit/paint_history.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace neuvv {

namespace {

// A layer's order, and beyond it one of all that an edit says.
auto rank(const LeafEdit& edit) {
    return std::tuple(edit.leaf, edit.first, edit.last, edit.colour.r, edit.colour.g, edit.colour.b, edit.alpha,
                      edit.sigma);
}
bool stands_before(const LeafEdit& a, const LeafEdit& b) {
    return rank(a) < rank(b);
}

// What of `a` is not in `b`.
std::vector<LeafEdit> less(const std::vector<LeafEdit>& a, const std::vector<LeafEdit>& b) {
    std::vector<LeafEdit> rest;
    std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest), stands_before);
    return rest;
}

}  // namespace

void PaintHistory::apply(EditLayer& layer, const Change& change) {
    const std::vector<LeafEdit> kept = less(layer.edits, change.removed);
    layer.edits.clear();
    std::merge(kept.begin(), kept.end(), change.added.begin(), change.added.end(), std::back_inserter(layer.edits),
               stands_before);
}

void PaintHistory::change(EditLayer& layer, std::vector<LeafEdit> after) {
    done_.push_back({less(layer.edits, after), less(after, layer.edits)});
    undone_.clear();
    layer.edits = std::move(after);
}

bool PaintHistory::undo(EditLayer& layer) {
    if (done_.empty()) return false;
    std::swap(done_.back().removed, done_.back().added);
    apply(layer, done_.back());
    undone_.push_back(std::move(done_.back()));
    done_.pop_back();
    return true;
}

bool PaintHistory::redo(EditLayer& layer) {
    if (undone_.empty()) return false;
    std::swap(undone_.back().removed, undone_.back().added);
    apply(layer, undone_.back());
    done_.push_back(std::move(undone_.back()));
    undone_.pop_back();
    return true;
}

}  // namespace neuvv

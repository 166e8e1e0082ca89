#include "editor/paint_operation.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace neuvv::editor {

namespace {

constexpr float kWhole = 0.5f;  // from such a share on, erasing and restoring take a leaf

bool by_halves(PaintOperation::Kind kind) {
    return kind == PaintOperation::Kind::kColour || kind == PaintOperation::Kind::kShift;
}

// The frames at which the work holds on each leaf, and the leaves that share them.
using Spans = std::map<std::pair<float, float>, std::vector<uint32_t>>;
Spans spans_of(const edit::Canvas& canvas, std::span<const SelectedLeaf> leaves, const edit::EditFrames& frames) {
    std::vector<voctree::LeafEdit> edits;
    for (const SelectedLeaf& chosen : leaves) edits.push_back({.leaf = chosen.leaf});
    Spans spans;
    for (const voctree::LeafEdit& edit : edit::at_frames(canvas, edits, frames))
        spans[{edit.first, edit.last}].push_back(edit.leaf);
    return spans;
}

std::vector<voctree::LeafEdit> shifted_edits(const edit::Canvas& canvas, std::span<const SelectedLeaf> leaves,
                                             const PaintOperation& operation) {
    std::unordered_map<uint32_t, float> shares;
    for (const SelectedLeaf& chosen : leaves) shares[chosen.leaf] = chosen.share;
    std::vector<voctree::LeafEdit> edits;
    for (const auto& [span, of_span] : spans_of(canvas, leaves, operation.frames))
        for (voctree::LeafEdit edit : edit::shift_colours(canvas, of_span, span.first, span.second, operation.shift)) {
            edit.alpha *= operation.opacity * shares[edit.leaf];
            edits.push_back(edit);
        }
    return edits;
}

// Only the edits of these leaves are gone through once a span; they may be few of many.
voctree::EditLayer restored(const edit::Canvas& canvas, const voctree::EditLayer& before,
                            std::span<const SelectedLeaf> leaves, const edit::EditFrames& frames) {
    std::vector<uint8_t> chosen(canvas.tree.leaf_count);
    for (const SelectedLeaf& one : leaves) chosen[one.leaf] = 1;
    voctree::EditLayer kept{before.field, {}}, cut{before.field, {}};
    for (const voctree::LeafEdit& edit : before.edits) (chosen[edit.leaf] ? cut : kept).edits.push_back(edit);
    for (const auto& [span, of_span] : spans_of(canvas, leaves, frames))
        voctree::remove_edits(cut, of_span, span.first, span.second);
    voctree::EditLayer after{before.field, {}};
    after.edits.reserve(kept.edits.size() + cut.edits.size());
    std::merge(kept.edits.begin(), kept.edits.end(), cut.edits.begin(), cut.edits.end(),
               std::back_inserter(after.edits),
               [](const voctree::LeafEdit& a, const voctree::LeafEdit& b) { return a.leaf < b.leaf; });
    return after;
}

}  // namespace

std::shared_ptr<const voctree::EditLayer> apply_operation(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                                          std::span<const SelectedLeaf> leaves,
                                                          const PaintOperation& operation) {
    std::vector<SelectedLeaf> taken(leaves.begin(), leaves.end());
    if (!by_halves(operation.kind)) std::erase_if(taken, [](const SelectedLeaf& one) { return one.share < kWhole; });
    if (taken.empty()) return nullptr;
    if (operation.kind == PaintOperation::Kind::kRestore)
        return std::make_shared<const voctree::EditLayer>(restored(canvas, before, taken, operation.frames));
    auto after = std::make_shared<voctree::EditLayer>(before);
    if (operation.kind == PaintOperation::Kind::kShift) {
        voctree::add_edits(*after, shifted_edits(canvas, taken, operation));
        return after;
    }
    const bool erases = operation.kind == PaintOperation::Kind::kErase;
    std::vector<voctree::LeafEdit> edits;
    for (const SelectedLeaf& one : taken)
        edits.push_back({.leaf = one.leaf,
                         .colour = erases ? glm::vec3(0) : operation.colour,
                         .alpha = erases ? 0 : operation.opacity * one.share,
                         .sigma = erases ? 0 : voctree::kKeepSigma});
    voctree::add_edits(*after, edit::at_frames(canvas, edits, operation.frames));
    return after;
}

std::vector<SelectedLeaf> leaves_for(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                     const edit::Region& region, const PaintOperation& operation) {
    std::vector<SelectedLeaf> chosen;
    if (operation.kind != PaintOperation::Kind::kRestore) {
        for (const uint32_t leaf : edit::leaves_in(canvas, region, operation.frames.first, operation.frames.last))
            chosen.push_back({leaf, 1});
        return chosen;
    }
    for (const voctree::LeafEdit& edit : before.edits)
        if ((chosen.empty() || chosen.back().leaf != edit.leaf) && region(canvas.middles[edit.leaf]))
            chosen.push_back({edit.leaf, 1});
    return chosen;
}

}  // namespace neuvv::editor

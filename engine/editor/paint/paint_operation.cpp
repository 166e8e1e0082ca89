#include "editor/paint/paint_operation.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace neuvv::editor {

namespace {

constexpr float kMinShare = 0.5f;  // from this share of a leaf on, densities, kErase and kRestore apply to it

// The ranges of frames at which the operation applies to the leaves, each with the leaves that share it.
using Spans = std::map<std::pair<float, float>, std::vector<uint32_t>>;
Spans spans_of(const edit::Canvas& canvas, std::span<const SelectedLeaf> leaves, const edit::EditFrames& frames) {
    std::vector<voctree::LeafEdit> edits;
    for (const SelectedLeaf& selected : leaves) edits.push_back({.leaf = selected.leaf});
    Spans spans;
    for (const voctree::LeafEdit& edit : edit::at_frames(canvas, edits, frames))
        spans[{edit.first, edit.last}].push_back(edit.leaf);
    return spans;
}

std::vector<voctree::LeafEdit> shifted_edits(const edit::Canvas& canvas, std::span<const SelectedLeaf> leaves,
                                             const PaintOperation& operation) {
    std::unordered_map<uint32_t, float> shares;
    for (const SelectedLeaf& selected : leaves) shares[selected.leaf] = selected.share;
    std::vector<voctree::LeafEdit> edits;
    for (const auto& [span, of_span] : spans_of(canvas, leaves, operation.frames))
        for (voctree::LeafEdit edit : edit::shift_colours(canvas, of_span, span.first, span.second, operation.shift)) {
            edit.alpha *= operation.opacity * shares[edit.leaf];
            edits.push_back(edit);
        }
    return edits;
}

// Only the edits of the selected leaves, which may be few of many, are searched once for each range of frames.
voctree::EditLayer restored(const edit::Canvas& canvas, const voctree::EditLayer& before,
                            std::span<const SelectedLeaf> leaves, const edit::EditFrames& frames) {
    std::vector<uint8_t> is_selected(canvas.tree.leaf_count);
    for (const SelectedLeaf& one : leaves) is_selected[one.leaf] = 1;
    voctree::EditLayer kept{before.field, {}}, cut{before.field, {}};
    for (const voctree::LeafEdit& edit : before.edits) (is_selected[edit.leaf] ? cut : kept).edits.push_back(edit);
    for (const auto& [span, of_span] : spans_of(canvas, leaves, frames))
        voctree::remove_edits(cut, of_span, span.first, span.second);
    voctree::EditLayer after{before.field, {}};
    after.edits.reserve(kept.edits.size() + cut.edits.size());
    std::merge(kept.edits.begin(), kept.edits.end(), cut.edits.begin(), cut.edits.end(),
               std::back_inserter(after.edits),
               [](const voctree::LeafEdit& a, const voctree::LeafEdit& b) { return a.leaf < b.leaf; });
    return after;
}

// The edits of kColour and kErase, without frames.
std::vector<voctree::LeafEdit> coloured_edits(std::span<const SelectedLeaf> leaves, const PaintOperation& operation) {
    const bool erases = operation.kind == PaintOperation::Kind::kErase;
    std::vector<voctree::LeafEdit> edits;
    for (const SelectedLeaf& one : leaves) {
        const float sigma = one.share < kMinShare ? voctree::kKeepSigma : erases ? 0 : operation.sigma;
        const float alpha = erases ? 0 : operation.opacity * one.share;
        if (alpha <= 0 && sigma < 0) continue;
        edits.push_back(
            {.leaf = one.leaf, .colour = erases ? glm::vec3(0) : operation.colour, .alpha = alpha, .sigma = sigma});
    }
    return edits;
}

// A density is an edit of its own, beside the edits that shift colours.
std::vector<voctree::LeafEdit> density_edits(std::span<const SelectedLeaf> leaves, const PaintOperation& operation) {
    PaintOperation density = operation;
    density.colour = glm::vec3(0);
    density.kind = PaintOperation::Kind::kColour;
    density.opacity = 0;
    return coloured_edits(leaves, density);
}

}  // namespace

std::shared_ptr<const voctree::EditLayer> apply_operation(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                                          std::span<const SelectedLeaf> leaves,
                                                          const PaintOperation& operation) {
    if (operation.kind == PaintOperation::Kind::kRestore) {
        std::vector<SelectedLeaf> selected(leaves.begin(), leaves.end());
        std::erase_if(selected, [](const SelectedLeaf& one) { return one.share < kMinShare; });
        if (selected.empty()) return nullptr;
        return std::make_shared<const voctree::EditLayer>(restored(canvas, before, selected, operation.frames));
    }
    const bool shifts = operation.kind == PaintOperation::Kind::kShift;
    std::vector<voctree::LeafEdit> edits = edit::at_frames(
        canvas, shifts ? density_edits(leaves, operation) : coloured_edits(leaves, operation), operation.frames);
    if (shifts) {
        const std::vector<voctree::LeafEdit> colours = shifted_edits(canvas, leaves, operation);
        edits.insert(edits.end(), colours.begin(), colours.end());
    }
    if (edits.empty()) return nullptr;
    auto after = std::make_shared<voctree::EditLayer>(before);
    voctree::add_edits(*after, edits);
    return after;
}

std::vector<SelectedLeaf> leaves_for(const edit::Canvas& canvas, const voctree::EditLayer& before,
                                     const edit::Region& region, const PaintOperation& operation) {
    std::vector<SelectedLeaf> selected;
    if (operation.kind == PaintOperation::Kind::kRestore) {
        for (const voctree::LeafEdit& edit : before.edits)
            if ((selected.empty() || selected.back().leaf != edit.leaf) && region(canvas.centres[edit.leaf]))
                selected.push_back({edit.leaf, 1});
        return selected;
    }
    const bool revives = operation.kind != PaintOperation::Kind::kErase && operation.sigma > 0;
    for (const uint32_t leaf : revives ? edit::all_leaves_in(canvas, region)
                                       : edit::leaves_in(canvas, region, operation.frames.first, operation.frames.last))
        selected.push_back({leaf, 1});
    return selected;
}

}  // namespace neuvv::editor

#include "voctree/edit_layer.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/paint.h"

namespace neuvv::voctree {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float just_before(float frame) {
    return std::nextafter(frame, -kInfinity);
}
float just_after(float frame) {
    return std::nextafter(frame, kInfinity);
}

LeafEdit between(LeafEdit edit, float first, float last) {
    edit.first = first;
    edit.last = last;
    return edit;
}

// Two edits as one, for frames where both apply: source over destination with straight alpha.
LeafEdit over(const LeafEdit& above, const LeafEdit& below) {
    LeafEdit both = above;
    both.alpha = above.alpha + below.alpha * (1 - above.alpha);
    if (both.alpha > 0 && above.alpha < 1)
        both.colour = (above.alpha * above.colour + (both.alpha - above.alpha) * below.colour) / both.alpha;
    both.colour = glm::clamp(both.colour, 0.0f, 1.0f);
    if (above.sigma < 0) both.sigma = below.sigma;
    return both;
}

bool has_same_effect(const LeafEdit& a, const LeafEdit& b) {
    return a.colour == b.colour && a.alpha == b.alpha && a.sigma == b.sigma;
}

// Appends an edit; where it continues the last one with the same effect, both become one.
void append(std::vector<LeafEdit>& edits, const LeafEdit& edit) {
    if (!edits.empty() && has_same_effect(edits.back(), edit) && just_after(edits.back().last) == edit.first)
        edits.back().last = edit.last;
    else
        edits.push_back(edit);
}

// Adds `top` over the edits of one leaf, which are in order of frames before and after.
void add_over(std::vector<LeafEdit>& edits, const LeafEdit& top) {
    std::vector<LeafEdit> result;
    float from = top.first;  // the first frame of the part of `top` that is not in `result` yet
    const auto append_top_until = [&](float last) {
        if (from <= last) append(result, between(top, from, last));
        from = just_after(last);
    };
    bool done = false;
    for (const LeafEdit& below : edits) {
        if (below.last < top.first) {
            append(result, below);
            continue;
        }
        if (below.first > top.last) {
            if (!done) append_top_until(top.last);
            done = true;
            append(result, below);
            continue;
        }
        if (below.first < top.first) append(result, between(below, below.first, just_before(top.first)));
        const float begin = std::max(below.first, top.first), end = std::min(below.last, top.last);
        if (from < begin) append_top_until(just_before(begin));
        append(result, between(over(top, below), begin, end));
        from = just_after(end);
        if (below.last > top.last) append(result, between(below, just_after(top.last), below.last));
    }
    if (!done) append_top_until(top.last);
    edits = std::move(result);
}

void cut_out(std::vector<LeafEdit>& edits, float first, float last) {
    std::vector<LeafEdit> result;
    for (const LeafEdit& edit : edits) {
        if (edit.last < first || edit.first > last) {
            result.push_back(edit);
            continue;
        }
        if (edit.first < first) result.push_back(between(edit, edit.first, just_before(first)));
        if (edit.last > last) result.push_back(between(edit, just_after(last), edit.last));
    }
    edits = std::move(result);
}

}  // namespace

PaintedField painted_field(const VOctree& tree) {
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
    if (!state) throw std::bad_alloc();
    XXH3_64bits_reset(state.get());
    XXH3_64bits_update(state.get(), &tree.node_levels, sizeof tree.node_levels);
    for (const TreeNode& node : tree.nodes) {
        const uint32_t words[3] = {node.mask_lo, node.mask_hi, node.first_child};
        XXH3_64bits_update(state.get(), words, sizeof words);
    }
    XXH3_64bits_update(state.get(), tree.children.data(), tree.children.size() * sizeof(uint32_t));
    return {XXH3_64bits_digest(state.get()), tree.leaf_count, tree.frames};
}

PaintLayers files_of_layer(const PaintLayers& layers, const std::filesystem::path& layer) {
    PaintLayers files;
    // Files in a folder come right behind it in the order of paths.
    for (auto file = layers.lower_bound(layer);
         file != layers.end() && (file->first == layer || file->first.parent_path() == layer); ++file)
        files.insert(*file);
    return files;
}

void add_edits(EditLayer& layer, std::span<const LeafEdit> edits) {
    std::vector<LeafEdit> added(edits.begin(), edits.end());
    std::stable_sort(added.begin(), added.end(), [](const LeafEdit& a, const LeafEdit& b) { return a.leaf < b.leaf; });
    std::vector<LeafEdit> result, of_leaf;
    result.reserve(layer.edits.size() + added.size());
    auto below = layer.edits.begin();
    for (auto above = added.begin(); above != added.end();) {
        const uint32_t leaf = above->leaf;
        for (; below != layer.edits.end() && below->leaf < leaf; ++below) result.push_back(*below);
        of_leaf.clear();
        for (; below != layer.edits.end() && below->leaf == leaf; ++below) of_leaf.push_back(*below);
        for (; above != added.end() && above->leaf == leaf; ++above) add_over(of_leaf, *above);
        result.insert(result.end(), of_leaf.begin(), of_leaf.end());
    }
    result.insert(result.end(), below, layer.edits.end());
    layer.edits = std::move(result);
}

void remove_edits(EditLayer& layer, std::span<const uint32_t> leaves, float first, float last) {
    if (!(first <= last)) return;
    std::vector<uint32_t> sorted(leaves.begin(), leaves.end());
    std::sort(sorted.begin(), sorted.end());
    std::vector<LeafEdit> result, of_leaf;
    result.reserve(layer.edits.size());
    auto next = sorted.begin();
    for (auto edit = layer.edits.begin(); edit != layer.edits.end();) {
        const uint32_t leaf = edit->leaf;
        of_leaf.clear();
        for (; edit != layer.edits.end() && edit->leaf == leaf; ++edit) of_leaf.push_back(*edit);
        next = std::lower_bound(next, sorted.end(), leaf);
        if (next != sorted.end() && *next == leaf) cut_out(of_leaf, first, last);
        result.insert(result.end(), of_leaf.begin(), of_leaf.end());
    }
    layer.edits = std::move(result);
}

std::string defect_of(const EditLayer& layer) {
    const float end = static_cast<float>(layer.field.frames) - 1;
    const auto in_unit = [](float value) { return value >= 0 && value <= 1; };
    for (size_t i = 0; i < layer.edits.size(); ++i) {
        const LeafEdit& edit = layer.edits[i];
        const auto of_edit = [i](const char* what) { return fmt::format("edit {} {}", i, what); };
        if (edit.leaf >= layer.field.leaf_count) return of_edit("names a leaf that does not exist");
        if (!(edit.first >= 0 && edit.first <= edit.last && edit.last <= end))
            return of_edit("applies to frames that do not exist");
        if (!in_unit(edit.colour.r) || !in_unit(edit.colour.g) || !in_unit(edit.colour.b))
            return of_edit("has a colour beyond 0 to 1");
        if (!in_unit(edit.alpha)) return of_edit("has an alpha beyond 0 to 1");
        if (edit.sigma != kKeepSigma && !(edit.sigma >= 0 && edit.sigma <= kMaxPaintSigma))
            return of_edit("has an invalid density");
        if (i == 0) continue;
        const LeafEdit& before = layer.edits[i - 1];
        if (before.leaf > edit.leaf || (before.leaf == edit.leaf && before.last >= edit.first))
            return of_edit("is out of order, or overlaps the one before it");
    }
    return "";
}

}  // namespace neuvv::voctree

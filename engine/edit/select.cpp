#include "edit/select.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/sigmoid.h"
#include "base/threads/parallel.h"

namespace neuvv::edit {

namespace {

constexpr size_t kGrain = 4096;  // leaves that a thread processes at once

float dot(const std::vector<float>& row, const float* weights) {
    float sum = 0;
    for (size_t c = 0; c < row.size(); ++c) sum += row[c] * weights[c];
    return sum;
}

std::vector<uint32_t> marked(const std::vector<uint8_t>& marks) {
    std::vector<uint32_t> leaves;
    for (uint32_t leaf = 0; leaf < marks.size(); ++leaf)
        if (marks[leaf]) leaves.push_back(leaf);
    return leaves;
}

using Span = std::pair<float, float>;  // of frames; both ends belong to it

// The runs of frames in which a leaf is opaque: all of them, or those that overlap first to last.
std::vector<Span> opaque_runs(const Canvas& canvas, uint32_t leaf, const EditFrames& frames) {
    const uint32_t count = canvas.tree.frames;
    const float threshold = -std::log(1 - frames.opaque) / canvas.edges_m[leaf];  // 1/m
    std::vector<float> sigma(count);
    voctree::density_of_frames(canvas.tree.leaf(leaf), canvas.rows, sigma);
    std::vector<Span> runs;
    for (uint32_t frame = 0; frame < count; ++frame) {
        if (!(sigma[frame] > threshold)) continue;
        uint32_t end = frame;
        while (end + 1 < count && sigma[end + 1] > threshold) ++end;
        const auto first = static_cast<float>(frame), last = static_cast<float>(end);
        const Span run(frame == 0 ? 0 : std::nextafter(first - 1, first),
                       end + 1 == count ? last : std::nextafter(last + 1, last));
        const bool meets = frames.first <= frames.last && run.first <= frames.last && run.second >= frames.first;
        if (frames.follow == Follow::kAll || meets) runs.push_back(run);
        frame = end;
    }
    return runs;
}

// Sorts spans and joins those that overlap.
std::vector<Span> joined(std::vector<Span> spans) {
    std::sort(spans.begin(), spans.end());
    std::vector<Span> result;
    for (const Span& span : spans) {
        if (!result.empty() && span.first <= result.back().second)
            result.back().second = std::max(result.back().second, span.second);
        else
            result.push_back(span);
    }
    return result;
}

}  // namespace

Canvas::Canvas(const voctree::VOctree& field)
    : tree(field), rows(voctree::basis_entries(field.sigma_basis, field.bases)) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    centres.reserve(positions.size());
    edges_m.reserve(positions.size());
    for (const voctree::LeafPosition& position : positions) {
        const float side = std::ldexp(1.0f, -static_cast<int>(position.depth));
        const glm::vec3 centre = (glm::vec3(position.x, position.y, position.z) + 0.5f) * side;
        centres.push_back(tree.box_min + centre * tree.box_size);
        edges_m.push_back(voctree::leaf_edge_m(tree, position.depth));
    }
}

std::vector<float> densities(const Canvas& canvas, float frame, std::span<const render::PaintUse> paint) {
    const voctree::VOctree& tree = canvas.tree;
    const voctree::RowsAtTime rows(tree, double{frame});
    std::vector<float> sigma(tree.leaf_count);
    parallel_for(sigma.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf) sigma[leaf] = density(tree, rows, static_cast<uint32_t>(leaf));
    });
    for (const render::PaintUse& use : paint)
        for (const voctree::LeafEdit& edit : use.layer->edits)
            if (edit.sigma >= 0 && edit.first <= frame && frame <= edit.last)
                sigma[edit.leaf] = std::lerp(sigma[edit.leaf], edit.sigma, use.opacity);
    return sigma;
}

float density(const voctree::VOctree& tree, const voctree::RowsAtTime& rows, uint32_t leaf) {
    return std::max(dot(rows.sigma, tree.leaf(leaf)), 0.0f);
}

glm::vec3 mean_colour(const voctree::VOctree& tree, const voctree::RowsAtTime& rows, uint32_t leaf) {
    constexpr float kPi = 3.14159265f, kY00 = 0.28209479f;
    const float* weights = tree.leaf(leaf);
    const float c = std::cos(kPi * sigmoid(dot(rows.gamma, weights + tree.bases)));
    // R_n0(γ) for the degrees n = 0 to 3 (errata 1, 2), and the indices of H_n00.
    const float radial[] = {1, 2 * c, 4 * c * c - 1, 8 * c * c * c - 4 * c};
    constexpr uint32_t kFunction[] = {0, 1, 5, 14};
    glm::vec3 colour;
    for (uint32_t channel = 0; channel < 3; ++channel) {
        const float* hh = weights + 2 * tree.bases + channel * hh_count(tree.hh_degree);
        float k = 0;
        for (uint32_t n = 0; n <= tree.hh_degree; ++n) k += std::sqrt(2 / kPi) * radial[n] * hh[kFunction[n]];
        colour[static_cast<int>(channel)] = sigmoid(kY00 * k);
    }
    return colour;
}

Region box_region(glm::vec3 low, glm::vec3 high) {
    return [=](glm::vec3 at) {
        return glm::all(glm::greaterThanEqual(at, low)) && glm::all(glm::lessThanEqual(at, high));
    };
}

Region sphere_region(glm::vec3 centre, float radius_m) {
    return [=](glm::vec3 at) { return glm::distance(at, centre) <= radius_m; };
}

Region either(Region a, Region b) {
    return [a = std::move(a), b = std::move(b)](glm::vec3 at) { return a(at) || b(at); };
}

Region both(Region a, Region b) {
    return [a = std::move(a), b = std::move(b)](glm::vec3 at) { return a(at) && b(at); };
}

Region without(Region a, Region b) {
    return [a = std::move(a), b = std::move(b)](glm::vec3 at) { return a(at) && !b(at); };
}

std::vector<uint32_t> all_leaves_in(const Canvas& canvas, const Region& region) {
    std::vector<uint32_t> leaves;
    for (uint32_t leaf = 0; leaf < canvas.tree.leaf_count; ++leaf)
        if (region(canvas.centres[leaf])) leaves.push_back(leaf);
    return leaves;
}

std::vector<uint32_t> leaves_in(const Canvas& canvas, const Region& region, float first, float last) {
    // Between two frames a density is interpolated, so it is largest at a whole frame or at `first` or `last`.
    std::vector<std::vector<float>> rows;
    const voctree::VOctree& tree = canvas.tree;
    for (const float frame : {first, last}) rows.push_back(voctree::RowsAtTime(tree, double{frame}).sigma);
    for (float frame = std::floor(first) + 1; frame < last; ++frame)
        rows.push_back(voctree::RowsAtTime(tree, double{frame}).sigma);
    std::vector<uint8_t> live(tree.leaf_count);
    parallel_for(live.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf)
            live[leaf] = region(canvas.centres[leaf]) && std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
                             return dot(row, tree.leaf(static_cast<uint32_t>(leaf))) > 0;
                         });
    });
    return marked(live);
}

std::vector<voctree::LeafEdit> in_runs(const Canvas& canvas, std::span<const voctree::LeafEdit> edits, float frame,
                                       float opaque) {
    const EditFrames frames{frame, frame, Follow::kRun, opaque};
    std::vector<voctree::LeafEdit> result;
    for (voctree::LeafEdit edit : edits)
        for (const auto& [first, last] : opaque_runs(canvas, edit.leaf, frames)) {
            edit.first = first;
            edit.last = last;
            result.push_back(edit);
        }
    return result;
}

std::vector<voctree::LeafEdit> at_frames(const Canvas& canvas, std::span<const voctree::LeafEdit> edits,
                                         const EditFrames& frames) {
    std::vector<voctree::LeafEdit> result;
    for (voctree::LeafEdit edit : edits) {
        std::vector<Span> spans;
        if (frames.follow != Follow::kNot) spans = opaque_runs(canvas, edit.leaf, frames);
        if (frames.first <= frames.last) spans.emplace_back(frames.first, frames.last);
        for (const auto& [first, last] : joined(std::move(spans))) {
            edit.first = first;
            edit.last = last;
            result.push_back(edit);
        }
    }
    return result;
}

std::vector<voctree::LeafEdit> extend_between_frames(std::vector<voctree::LeafEdit> edits, float first, float last) {
    std::sort(edits.begin(), edits.end(), [](const voctree::LeafEdit& a, const voctree::LeafEdit& b) {
        return std::pair(a.leaf, a.first) < std::pair(b.leaf, b.first);
    });
    constexpr float kEver = std::numeric_limits<float>::infinity();
    const std::vector<voctree::LeafEdit> given = edits;
    for (size_t i = 0; i < given.size(); ++i) {
        const voctree::LeafEdit& edit = given[i];
        const float before = i > 0 && given[i - 1].leaf == edit.leaf ? given[i - 1].last : -kEver;
        const float after = i + 1 < given.size() && given[i + 1].leaf == edit.leaf ? given[i + 1].first : kEver;
        const float previous = std::ceil(edit.first) - 1, next = std::floor(edit.last) + 1;
        const float begin = before < previous ? std::nextafter(previous, edit.first) : 0.5f * (before + edit.first);
        const float end = std::nextafter(after > next ? next : 0.5f * (edit.last + after), edit.last);
        edits[i].first = std::clamp(begin, first, edit.first);
        edits[i].last = std::clamp(end, edit.last, last);
    }
    return edits;
}

}  // namespace neuvv::edit

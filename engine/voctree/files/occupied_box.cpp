#include "voctree/files/occupied_box.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "slice/quantise.h"
#include "voctree/files/clip.h"

namespace neuvv::voctree {

std::pair<glm::dvec3, glm::dvec3> occupied_box(const VOctree& tree) {
    return occupied_box(leaf_positions(tree), tree.box_min, tree.box_size);
}

std::pair<glm::dvec3, glm::dvec3> occupied_box(const std::vector<LeafPosition>& leaves, glm::vec3 box_min,
                                               glm::vec3 box_size) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const LeafPosition& position : leaves) {
        const double edge = std::ldexp(1.0, -static_cast<int>(position.depth));
        const glm::dvec3 corner = glm::dvec3(position.x, position.y, position.z) * edge;
        low = glm::min(low, corner);
        high = glm::max(high, corner + edge);
    }
    if (leaves.empty()) {
        low = glm::dvec3(0);
        high = glm::dvec3(1);
    }
    const glm::dvec3 origin(box_min), size(box_size);
    return {origin + low * size, origin + high * size};
}

namespace {

using Box = std::pair<glm::dvec3, glm::dvec3>;

constexpr size_t kMostSegments = 8;
constexpr double kMoves = 0.1;  // by how much of their box's size leaves of a stream may move between the frames read

// The segments whose leaves are read. Of a stream these are key frames, because others need those before them.
std::vector<ClipSegment> sample_of(const ClipIndex& clip) {
    std::vector<ClipSegment> all, some;
    for (const ClipSegment& segment : clip.segments)
        if (!segment.stream || segment.stream->index().frames[segment.first].is_key) all.push_back(segment);
    const size_t count = std::min(all.size(), kMostSegments);
    for (size_t i = 0; i < count; ++i) some.push_back(all[count == 1 ? 0 : i * (all.size() - 1) / (count - 1)]);
    return some;
}

// Around the leaves of a segment, and whether it has any. As little of it is read as has to be.
struct SegmentBox {
    Box box;
    bool has_leaves;
};

// Also of the frames around it.
SegmentBox box_of_frame(const ClipSegment& frame) {
    const FrameSlice read = read_slice(frame, stream::kShape);
    const Box leaves = occupied_box(leaf_positions(*read.slice), read.box_min, read.box_size);
    const glm::dvec3 low(read.box_min), high = low + glm::dvec3(read.box_size),
                                        moved = kMoves * (leaves.second - leaves.first);
    return {{glm::max(low, leaves.first - moved), glm::min(high, leaves.second + moved)}, !read.slice->leaves.empty()};
}

SegmentBox box_of(const ClipSegment& segment) {
    if (segment.stream) return box_of_frame(segment);
    std::optional<VOctree> tree;
    if (kind_of(segment.file) == ClipKind::kNvv) tree = read_nvv_coarse(segment.file);
    if (!tree) tree = read_segment(segment);
    return {occupied_box(*tree), tree->leaf_count > 0};
}

}  // namespace

Box occupied_box(const ClipIndex& clip) {
    std::optional<Box> box, empty;  // of segments with leaves, and of one without
    Note problem;
    for (const ClipSegment& segment : sample_of(clip)) {
        try {
            const auto [one, has_leaves] = box_of(segment);
            if (has_leaves)
                box = box ? Box(glm::min(box->first, one.first), glm::max(box->second, one.second)) : one;
            else
                empty = one;
        } catch (const InputError& error) {
            if (problem.empty()) problem = Note(error);
        }
    }
    if (!box && !empty)
        throw InputError(clip.segments[0].file.parent_path().string(), "",
                         "none of its segments can be read: " + problem.text, problem.fix);
    return box ? *box : *empty;
}

}  // namespace neuvv::voctree

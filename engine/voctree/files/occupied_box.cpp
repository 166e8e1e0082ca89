#include "voctree/files/occupied_box.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "voctree/kinds/clip_source.h"

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

// The segments whose leaves are read.
std::vector<ClipSegment> sample_of(const ClipIndex& clip) {
    std::vector<ClipSegment> all, some;
    for (const ClipSegment& segment : clip.segments)
        if (segment.source->stands_alone(segment)) all.push_back(segment);
    const size_t count = std::min(all.size(), kMostSegments);
    for (size_t i = 0; i < count; ++i) some.push_back(all[count == 1 ? 0 : i * (all.size() - 1) / (count - 1)]);
    return some;
}

}  // namespace

Box occupied_box(const ClipIndex& clip) {
    if (const auto all = clip.segments[0].source->box_of_all()) return {all->low, all->high};
    std::optional<Box> box, empty;  // of segments with leaves, and of one without
    Note problem;
    for (const ClipSegment& segment : sample_of(clip)) {
        try {
            const ClipSource::Box of_segment = segment.source->box(segment);
            const Box one(of_segment.low, of_segment.high);
            if (of_segment.has_leaves)
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

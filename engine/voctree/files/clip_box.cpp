#include "voctree/files/clip_box.h"

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "voctree/kinds/clip_source.h"

namespace neuvv::voctree {

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

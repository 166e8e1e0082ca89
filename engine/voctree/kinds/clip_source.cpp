#include "voctree/kinds/clip_source.h"

#include <cassert>

#include "voctree/tree_slice.h"

namespace neuvv::voctree {

slice::Slice slice_at(const SegmentContent& content, double frame, std::span<const PaintStep> paint) {
    if (const auto* tree = std::get_if<VOctree>(&content)) return slice_of(*tree, frame, paint);
    assert(paint.empty());
    const auto& one = std::get<FrameSlice>(content);
    slice::Slice values = slice::values_of(*one.slice, one.box_min, one.box_size);
    std::erase_if(values.leaves, [](const slice::Leaf& leaf) { return leaf.shown <= 0; });
    return values;
}

}  // namespace neuvv::voctree

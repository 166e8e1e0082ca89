#include "render/clips/uploaded_segment.h"

#include "base/seconds.h"
#include "render/volume/slices/slice_upload.h"

namespace neuvv::render {

namespace {

// Without its paint.
UploadedSegment upload_tree(const gpu::Device& device, const voctree::VOctree& tree, FarLevels far, SolidParts solid) {
    return {
        far == FarLevels::kYes ? upload_far_levels(device, tree) : upload_field(device, tree, WeightPrecision::kHalf),
        {},
        solid == SolidParts::kYes ? std::make_shared<const voctree::SolidLeaves>(tree) : nullptr};
}

UploadedSegment upload_frame(const gpu::Device& device, const voctree::FrameSlice& frame, SolidParts solid) {
    UploadedSegment uploaded{upload_slice(device, *frame.slice, frame.box_min, frame.box_size), {}, nullptr};
    if (solid == SolidParts::kYes)
        uploaded.solid = std::make_shared<const voctree::SolidLeaves>(*frame.slice, frame.box_min, frame.box_size);
    return uploaded;
}

}  // namespace

UploadedSegment upload_content(const gpu::Device& device, const voctree::SegmentContent& content, FarLevels far,
                               SolidParts solid) {
    if (const auto* tree = std::get_if<voctree::VOctree>(&content)) {
        UploadedSegment uploaded = upload_tree(device, *tree, far, solid);
        uploaded.painted = voctree::painted_field(*tree);
        return uploaded;
    }
    const double begin_s = seconds_now();
    const auto& frame = std::get<voctree::FrameSlice>(content);
    UploadedSegment uploaded = upload_frame(device, frame, solid);
    uploaded.times = SegmentTimes{frame.times, seconds_now() - begin_s};
    return uploaded;
}

UploadedSegment upload_segment(const gpu::Device& device, const voctree::ClipSegment& segment, FarLevels far,
                               SolidParts solid, stream::Part last) {
    return upload_content(device, segment.source->content(segment, last, voctree::PlenoctreeColours::kAsStored), far,
                          solid);
}

std::optional<UploadedSegment> upload_coarse(const gpu::Device& device, const voctree::ClipSegment& segment,
                                             SolidParts solid) {
    const std::optional<voctree::VOctree> tree = segment.source->coarse(segment);
    if (!tree) return {};
    return upload_tree(device, *tree, FarLevels::kNo, solid);
}

}  // namespace neuvv::render

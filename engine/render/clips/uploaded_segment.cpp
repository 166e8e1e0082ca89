#include "render/clips/uploaded_segment.h"

#include "base/platform.h"
#include "base/seconds.h"
#include "render/volume/slices/slice_upload.h"
#include "voctree/files/clip.h"

namespace neuvv::render {

namespace {

UploadedSegment upload_frame(const gpu::Device& device, const voctree::ClipSegment& segment, SolidParts solid,
                             stream::Part last) {
    keep_freed_memory();  // a frame has tens of megabytes of arrays, which take as long to clear as to fill
    const voctree::FrameSlice frame = voctree::read_slice(segment, last);
    const double begin_s = seconds_now();
    UploadedSegment uploaded{upload_slice(device, *frame.slice, frame.box_min, frame.box_size), {}, nullptr};
    if (solid == SolidParts::kYes)
        uploaded.solid = std::make_shared<const voctree::SolidLeaves>(*frame.slice, frame.box_min, frame.box_size);
    segment.stream->learn_upload(seconds_now() - begin_s);
    return uploaded;
}

}  // namespace

UploadedSegment upload_segment(const gpu::Device& device, const voctree::ClipSegment& segment, FarLevels far,
                               SolidParts solid, stream::Part last) {
    if (segment.stream) return upload_frame(device, segment, solid, last);
    const voctree::VOctree tree = voctree::read_shown_segment(segment);
    return {
        far == FarLevels::kYes ? upload_far_levels(device, tree) : upload_field(device, tree, WeightPrecision::kHalf),
        voctree::painted_field(tree),
        solid == SolidParts::kYes ? std::make_shared<const voctree::SolidLeaves>(tree) : nullptr};
}

}  // namespace neuvv::render

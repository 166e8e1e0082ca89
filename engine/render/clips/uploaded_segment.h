// A segment of a clip, or a frame of a stream, on the device in the form in which players draw it.
#pragma once

#include <memory>
#include <optional>

#include "render/volume/field_levels.h"
#include "voctree/edit_layer.h"
#include "voctree/files/solid_leaves.h"
#include "voctree/kinds/clip_source.h"

namespace neuvv::render {

// Whether to find the solid parts of each file, which the headset alone needs.
enum class SolidParts { kNo, kYes };

// What it took to bring a frame of a stream to the device.
struct SegmentTimes {
    stream::DecodeTimes decoded;
    double upload_s = 0;
};

struct UploadedSegment {
    Field field;
    voctree::PaintedField painted;                      // nothing of a frame of a stream, which has no paint
    std::shared_ptr<const voctree::SolidLeaves> solid;  // of the file, needs no device; null without SolidParts::kYes
    std::optional<SegmentTimes> times{};                // nothing of a file
};

enum class FarLevels { kNo, kYes };

// Reads a segment and uploads it. A file gets far levels where `far` says so. A slice has none, because
// merging leaves would take longer than the frame is shown; it is decoded from its parts up to `last`. Throws
// InputError as ClipSource::content does, and RuntimeFailure where the device has no memory.
UploadedSegment upload_segment(const gpu::Device& device, const voctree::ClipSegment& segment,
                               FarLevels far = FarLevels::kYes, SolidParts solid = SolidParts::kNo,
                               stream::Part last = stream::kShFine);
// The same of what its source has read, with the colours of a PlenOctree as they are stored.
UploadedSegment upload_content(const gpu::Device& device, const voctree::SegmentContent& content,
                               FarLevels far = FarLevels::kYes, SolidParts solid = SolidParts::kNo);
// What stands in for a segment until the whole is read; nothing where its file has no such tree. It has no paint.
std::optional<UploadedSegment> upload_coarse(const gpu::Device& device, const voctree::ClipSegment& segment,
                                             SolidParts solid);

}  // namespace neuvv::render

#include "tools/export/exported_clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "stage/time_map.h"
#include "tools/options.h"
#include "voctree/slice.h"

namespace neuvv::tools {

// A clip keeps its rate as a float, so that of the export is rounded to one, too: otherwise 59.94 frames a second would
// drift off those of a clip of 29.97.
ExportedClip::ExportedClip(PublishedScene scene, std::optional<double> fps)
    : scene_(std::move(scene)), fps_(double{fps ? static_cast<float>(*fps) : scene_.index.fps}) {
    step_ = double{scene_.index.fps} / fps_;
}

ExportedClip::Frames ExportedClip::frames_in(const std::string& range) const {
    const FrameRange part = parse_frame_range(range, scene_.index.frames());
    if (part.first != std::floor(part.first) || part.last != std::floor(part.last))
        throw InputError("--frames", range, "lies between two frames", "write whole frames");
    const auto first_from = [&](double recorded) { return std::ceil(recorded / step_ - stage::kFrameTolerance); };
    const double first = first_from(part.first), end = first_from(part.last + 1);
    if (!(end <= voctree::kMaxClipFrames))
        throw InputError("--fps", fmt::format("{}", fps_),
                         fmt::format("makes more than {} frames", voctree::kMaxClipFrames), "choose a lower one");
    if (!(first < end))
        throw InputError("--frames", range, fmt::format("has no frame at {} a second", fps_),
                         "choose more of them, or a higher --fps");
    return {static_cast<uint32_t>(first), static_cast<uint32_t>(end) - 1};
}

double ExportedClip::recorded_frame(uint32_t frame) const {
    const double at = frame * step_, whole = std::round(at);
    return std::min(std::abs(at - whole) <= stage::kFrameTolerance ? whole : at, scene_.index.frames() - 1.0);
}

ExportedClip::Shown ExportedClip::shown(uint32_t frame) {
    const voctree::SegmentFrame at = voctree::segment_frame(scene_.index, recorded_frame(frame));
    if (!segment_ || segment_number_ != at.segment) {
        segment_.reset();  // before the next one is read: together they may be too large
        segment_ = std::make_unique<Segment>(scene_, scene_.index.segments[at.segment]);
        segment_number_ = at.segment;
    }
    return {*segment_, double{at.frame}};
}

voctree::VOctree ExportedClip::still(uint32_t frame) {
    const auto& [segment, at] = shown(frame);
    return voctree::tree_of(voctree::slice_of(segment.tree, at, segment.paint.steps), segment.tree.box_min,
                            segment.tree.box_size, segment.tree.fps);
}

interchange::FrameVolume ExportedClip::volume(uint32_t frame) {
    const auto& [segment, at] = shown(frame);
    return interchange::frame_volume(segment.tree, at, segment.paint.steps);
}

}  // namespace neuvv::tools

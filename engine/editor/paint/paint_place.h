// Where a performer's clip is painted: in the segment that is seen. A clip that is one file is a single segment.
#pragma once

#include <filesystem>
#include <memory>

#include "voctree/files/clip_index.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::editor {

struct PaintPlace {
    std::shared_ptr<const voctree::ClipIndex> index;
    uint32_t segment_index = 0;
    float frame = 0;  // in the segment's file

    PaintPlace() = default;
    // At a frame of the clip.
    PaintPlace(std::shared_ptr<const voctree::ClipIndex> of, float clip_frame) : index(std::move(of)) {
        const voctree::SegmentFrame at = voctree::segment_frame(*index, double{clip_frame});
        segment_index = at.segment;
        frame = at.frame;
    }
    // The same frame as one of the clip. Between two segments without an overlap, it is the nearer one.
    float clip_frame() const { return static_cast<float>(segment().first) + frame; }
    bool is_segmented() const { return index->segments.size() > 1; }
    const voctree::ClipSegment& segment() const { return index->segments[segment_index]; }
    // The file of a layer that holds this segment's part of it: of a clip that is one file, the layer itself.
    std::filesystem::path layer_file(const std::filesystem::path& layer) const {
        return is_segmented() ? voctree::paint_file(layer, segment()) : layer;
    }
};

}  // namespace neuvv::editor

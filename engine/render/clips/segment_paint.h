// Paint of segments: a performer's layers on a clip in segments, each a folder with a file for every painted segment
// (voctree/files/nvpaint.h). They are read and uploaded together with a segment.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/file_stamp.h"
#include "render/volume/slices/paint.h"
#include "voctree/files/clip_index.h"

namespace neuvv::render {

struct LayerFolder {
    std::filesystem::path folder;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
    voctree::PaintLayers edited{};  // files of the folder, as edited, in place of those on the disk
    bool operator==(const LayerFolder&) const = default;
};
// The visible layers of a performer, the lowest first.
using LayerFolders = std::vector<LayerFolder>;
// The same, of their edited files only those of this segment.
LayerFolders of_segment(const LayerFolders& layers, const voctree::ClipSegment& segment);

// What layers hold for one segment.
struct SegmentPaint {
    LayerFolders layers;                 // of_segment
    std::vector<FileStamp> stamps;       // of the segment's file in each layer
    std::shared_ptr<const Paint> paint;  // null: no leaf of the segment is painted
    Note problem;                        // why it cannot be read and is left out; mostly empty
};

// The stamps of the segment's file in each layer.
std::vector<FileStamp> stamps_of(const LayerFolders& layers, const voctree::ClipSegment& segment);

// Reads and uploads the paint of a segment; null where no leaf of it is painted. Throws InputError where
// voctree::read_segment_paint does, and for an edited file of another field; RuntimeFailure where the device has no
// memory.
std::shared_ptr<const Paint> load_segment_paint(const gpu::Device& device, const LayerFolders& layers,
                                                const voctree::ClipSegment& segment,
                                                const voctree::PaintedField& field);

}  // namespace neuvv::render

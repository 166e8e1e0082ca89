#include "render/segment_paint.h"

#include "voctree/nvpaint.h"

namespace neuvv::render {

std::vector<FileStamp> stamps_of(const LayerFolders& layers, const voctree::ClipSegment& segment) {
    std::vector<FileStamp> stamps;
    for (const LayerFolder& layer : layers) stamps.push_back(stamp_of(voctree::paint_file(layer.folder, segment)));
    return stamps;
}

std::shared_ptr<const Paint> load_segment_paint(const gpu::Device& device, const LayerFolders& layers,
                                                const voctree::ClipSegment& segment,
                                                const voctree::PaintedField& field) {
    std::vector<voctree::EditLayer> edits;
    edits.reserve(layers.size());  // `uses` points to them
    std::vector<PaintUse> uses;
    for (const LayerFolder& layer : layers) {
        edits.push_back(voctree::read_segment_paint(layer.folder, segment, field));
        if (!edits.back().edits.empty()) uses.push_back({&edits.back(), layer.blend, layer.opacity});
    }
    return uses.empty() ? nullptr : std::make_shared<const Paint>(device, field.leaf_count, uses);
}

}  // namespace neuvv::render

#include "render/clips/segment_paint.h"

#include "base/error.h"
#include "voctree/files/nvpaint.h"

namespace neuvv::render {

LayerFolders of_segment(const LayerFolders& layers, const voctree::ClipSegment& segment) {
    LayerFolders folders;
    for (const LayerFolder& layer : layers) {
        folders.push_back({layer.folder, layer.blend, layer.opacity});
        const auto edited = layer.edited.find(voctree::paint_file(layer.folder, segment));
        if (edited != layer.edited.end()) folders.back().edited.insert(*edited);
    }
    return folders;
}

std::vector<FileStamp> stamps_of(const LayerFolders& layers, const voctree::ClipSegment& segment) {
    std::vector<FileStamp> stamps;
    for (const LayerFolder& layer : layers) stamps.push_back(stamp_of(voctree::paint_file(layer.folder, segment)));
    return stamps;
}

std::shared_ptr<const Paint> load_segment_paint(const gpu::Device& device, const LayerFolders& layers,
                                                const voctree::ClipSegment& segment,
                                                const voctree::PaintedField& field) {
    std::vector<std::shared_ptr<const voctree::EditLayer>> edits;  // `uses` points to them
    std::vector<PaintUse> uses;
    for (const LayerFolder& layer : layers) {
        const std::filesystem::path file = voctree::paint_file(layer.folder, segment);
        const auto edited = layer.edited.find(file);
        edits.push_back(edited != layer.edited.end() ? edited->second
                                                     : std::make_shared<const voctree::EditLayer>(
                                                           voctree::read_segment_paint(layer.folder, segment, field)));
        if (edits.back()->field != field)
            throw InputError(file.string(), "", "is paint for another clip", "paint on this one anew");
        if (!edits.back()->edits.empty()) uses.push_back({edits.back().get(), layer.blend, layer.opacity});
    }
    return uses.empty() ? nullptr : std::make_shared<const Paint>(device, field.leaf_count, uses);
}

}  // namespace neuvv::render

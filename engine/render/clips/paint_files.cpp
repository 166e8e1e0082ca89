#include "render/clips/paint_files.h"

#include "voctree/files/nvpaint.h"

namespace neuvv::render {

std::shared_ptr<const voctree::EditLayer> PaintFiles::read(const std::filesystem::path& path,
                                                           const voctree::PaintedField& field) {
    const FileStamp stamp = stamp_of(path);
    const auto known = files_.find(path);
    if (known != files_.end() && known->second.stamp == stamp && known->second.layer->field == field)
        return known->second.layer;
    auto layer = std::make_shared<const voctree::EditLayer>(voctree::read_paint(path, field));
    files_[path] = {stamp, layer};
    return layer;
}

void PaintFiles::drop_unused() {
    std::erase_if(files_, [](const auto& file) { return file.second.layer.use_count() == 1; });
}

}  // namespace neuvv::render

// Layers of paint on the disk. Each is read once for as long as its file stays the same.
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "base/file_stamp.h"
#include "voctree/edit_layer.h"

namespace neuvv::render {

// Returns the files of a layer that are edited (voctree::files_of_layer): each the same pointer for as long as it is
// unchanged, and another pointer once it has been painted on. Others are read from the disk.
using PaintSource = std::function<voctree::PaintLayers(const std::filesystem::path& layer)>;

class PaintFiles {
  public:
    // Reads the file, or returns the layer that was read before, where the file has not changed. Throws InputError as
    // read_paint does.
    std::shared_ptr<const voctree::EditLayer> read(const std::filesystem::path& path,
                                                   const voctree::PaintedField& field);
    // Drops the layers to which there are no other pointers.
    void drop_unused();

  private:
    struct Read {
        FileStamp stamp;
        std::shared_ptr<const voctree::EditLayer> layer;
    };
    std::map<std::filesystem::path, Read> files_;
};

}  // namespace neuvv::render

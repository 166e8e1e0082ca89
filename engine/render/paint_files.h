// Layers of paint on the disk. Each is read once for as long as its file stays the same.
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "base/file_stamp.h"
#include "voctree/paint.h"

namespace neuvv::render {

// Returns the layer for the path of a paint file and a field: the same pointer for as long as the layer is unchanged,
// and another pointer once it has been painted on. Null: the layer is to be read from the disk.
using PaintSource = std::function<std::shared_ptr<const voctree::EditLayer>(const std::filesystem::path& path,
                                                                            const voctree::PaintedField& field)>;

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

// Layers of paint as they are on the disk, each read once for as long as its file stays the same.
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "base/file_stamp.h"
#include "voctree/paint.h"

namespace neuvv::render {

// The layer that a file's path stands for, of this field: the same pointer for as long as it is the same layer, another
// one once it has been painted on. Null: as it is on the disk.
using PaintSource = std::function<std::shared_ptr<const voctree::EditLayer>(const std::filesystem::path& path,
                                                                            const voctree::PaintedField& field)>;

class PaintFiles {
  public:
    // As a source. Throws InputError as read_paint does.
    std::shared_ptr<const voctree::EditLayer> read(const std::filesystem::path& path,
                                                   const voctree::PaintedField& field);
    // Those that nobody else has any more.
    void drop_unused();

  private:
    struct Read {
        FileStamp stamp;
        std::shared_ptr<const voctree::EditLayer> layer;
    };
    std::map<std::filesystem::path, Read> files_;
};

}  // namespace neuvv::render

// Reads and writes .nvpaint files, each a layer of paint. The byte layout is specified in engine/voctree/README.md.
#pragma once

#include <filesystem>

#include "voctree/paint.h"

namespace neuvv::voctree {

// Writes the file atomically. Throws RuntimeFailure where the disk fails or the layer has a defect_of, and then leaves
// the old file as it was.
void write_paint(const std::filesystem::path& path, const EditLayer& layer);

// Throws InputError naming the file, the chunk and the fix. Every number in the file is checked. A layer of another
// field is refused, and so is one of this field whose leaves have changed since.
EditLayer read_paint(const std::filesystem::path& path, const PaintedField& field);

}  // namespace neuvv::voctree

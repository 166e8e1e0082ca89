// The .nvpaint file: a layer of paint at rest. The byte layout is specified in engine/voctree/README.md.
#pragma once

#include <filesystem>

#include "voctree/paint.h"

namespace neuvv::voctree {

// Atomic. Throws RuntimeFailure (the disk; a layer with a defect_of) and then leaves the old file.
void write_paint(const std::filesystem::path& path, const EditLayer& layer);

// Throws InputError naming the file, the chunk and the fix; never trusts a number in the file. A layer of another
// field, or of one with other leaves since, is refused.
EditLayer read_paint(const std::filesystem::path& path, const PaintedField& field);

}  // namespace neuvv::voctree

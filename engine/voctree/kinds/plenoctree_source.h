// PlenOctrees, as clips of one frame.
#pragma once

#include "voctree/kinds/clip_source.h"

namespace neuvv::voctree {

ClipIndex index_of_plenoctree(const std::filesystem::path& path, UpAxis up);

}  // namespace neuvv::voctree

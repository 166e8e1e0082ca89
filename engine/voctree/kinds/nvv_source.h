// Clips that are .nvv files.
#pragma once

#include "voctree/kinds/clip_source.h"

namespace neuvv::voctree {

// The index of a clip that is one .nvv, of which the header is read.
ClipIndex index_of_nvv(const std::filesystem::path& path);

}  // namespace neuvv::voctree

// Streams: each frame is a segment, and comes as its slice.
#pragma once

#include "stream/transport/nvs_reader.h"
#include "voctree/kinds/clip_source.h"

namespace neuvv::voctree {

// The stream's file, or its address, opened. One that is open already is not opened again, unless its file has changed,
// or it was found to be damaged or changed on its server: what it has read and decoded is there. Throws as
// stream::Reader does.
std::shared_ptr<stream::Reader> open_stream(const std::filesystem::path& path);

ClipIndex index_of_stream(const std::filesystem::path& path);

}  // namespace neuvv::voctree

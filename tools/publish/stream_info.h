// What `neuvv info` says of a stream.
#pragma once

#include <filesystem>

namespace neuvv::tools {

// With `check`, all frames are decoded. Throws InputError where the stream, or such a frame, is damaged.
void print_stream_info(const std::filesystem::path& path, bool json, bool check);

}  // namespace neuvv::tools

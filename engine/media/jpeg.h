// JPEG files, as cameras write them. image.h reads them.
#pragma once

#include <filesystem>
#include <vector>

#include "media/image.h"

namespace neuvv::media {

// The bytes of a baseline JPEG with colour at half the resolution; alpha is dropped. `quality` is libjpeg's, 1 to 100
// (assert). Throws RuntimeFailure.
std::vector<uint8_t> encode_jpeg(const Image& image, int quality);
// Writes the same as a file, atomically. Throws RuntimeFailure.
void write_jpeg(const std::filesystem::path& path, const Image& image, int quality);

}  // namespace neuvv::media

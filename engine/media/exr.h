// OpenEXR: images of linear light, for compositing and environment maps.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "media/cryptomatte.h"

namespace neuvv::media {

// An image of linear light (Rec. 709 primaries), row-major from the top left.
struct LinearImage {
    uint32_t width = 0, height = 0;
    std::vector<float> rgba;     // premultiplied
    std::vector<float> depth_m;  // one value per pixel, infinite where the pixel shows nothing; or empty
    double pixel_aspect = 1;     // width of a pixel / its height
    IdImage ids{};               // without pixels: none
};

// Writes R, G, B, A as halves (values beyond ±65504 are clamped), Z as floats, and identifiers with their coverage as
// floats (cryptomatte.h), ZIP-compressed, atomically. The image may lack any of the three, but not all. The same image
// gives the same bytes. Throws RuntimeFailure.
void write_exr(const std::filesystem::path& file, const LinearImage& image);

constexpr uint64_t kMaxExrPixels = uint64_t{1} << 27;  // 16384×8192

// Reads colour and depth of a flat file of scan lines or tiles with any compression and the channels R, G, B; A is 1
// where it is missing. The data window becomes the image. Throws InputError for damaged or other files, sizes beyond
// kMaxImageSide or kMaxExrPixels, and colours that are not finite.
LinearImage read_exr(const std::filesystem::path& file);

}  // namespace neuvv::media

// OpenEXR: images of linear light for compositing, and environment maps.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace neuvv::media {

// Linear light (Rec. 709 primaries), row-major from the top left.
struct LinearImage {
    uint32_t width = 0, height = 0;
    std::vector<float> rgba;     // premultiplied
    std::vector<float> depth_m;  // a value a pixel, infinite where nothing is seen; or empty
    double pixel_aspect = 1;     // a pixel's width over its height
};

// R, G, B, A as halves (values beyond ±65504 are clamped to it) and Z as floats, ZIP-compressed; atomically. The same
// image gives the same bytes. Throws RuntimeFailure.
void write_exr(const std::filesystem::path& file, const LinearImage& image);

constexpr uint64_t kMaxExrPixels = uint64_t{1} << 27;  // 16384×8192

// A flat file of scan lines or tiles, any compression, with channels R, G, B; A is 1 where it is missing. The data
// window is the image. Throws InputError for damage, other kinds of file, sizes beyond kMaxImageSide or
// kMaxExrPixels, and colours that are not finite.
LinearImage read_exr(const std::filesystem::path& file);

}  // namespace neuvv::media

// Deep OpenEXR: several samples a pixel, each a part of the depth, so that other things can be put between them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace neuvv::media {

// A homogeneous medium between two depths, or a surface where they are equal.
struct DeepSample {
    float near_m = 0, far_m = 0;   // along the camera's axis
    std::array<float, 4> rgba{0};  // linear light and alpha of the sample alone, premultiplied
};

// Row-major from the top left. Samples of a pixel do not overlap, and lie from near to far.
struct DeepImage {
    uint32_t width = 0, height = 0;
    std::vector<uint32_t> counts;     // samples of each pixel
    std::vector<DeepSample> samples;  // pixel after pixel
};

// Writes deep scan lines: R, G, B, A as halves, Z and ZBack as floats, ZIPS-compressed, atomically. The same image
// gives the same bytes. Throws RuntimeFailure.
void write_deep_exr(const std::filesystem::path& file, const DeepImage& image);

}  // namespace neuvv::media

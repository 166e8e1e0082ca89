// Images in memory, PNG in and out. sRGB-encoded 8-bit with straight alpha: the form of image files. Everything
// inside the engine is linear and premultiplied instead; the two conversions stand here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory_resource>
#include <vector>

namespace neuvv::media {

// Row-major from the top left, 4 bytes a pixel: R, G, B sRGB-encoded, straight A.
struct Image {
    uint32_t width = 0;
    uint32_t height = 0;
    std::pmr::vector<uint8_t> rgba;  // keeps its memory resource for life, as vectors of pmr do

    Image() = default;
    explicit Image(std::pmr::memory_resource* memory) : rgba(memory) {}
    Image(uint32_t w, uint32_t h) : width(w), height(h), rgba(size_t{4} * w * h) {}
    uint8_t* at(uint32_t x, uint32_t y) { return &rgba[(size_t{y} * width + x) * 4]; }
    const uint8_t* at(uint32_t x, uint32_t y) const { return &rgba[(size_t{y} * width + x) * 4]; }
};

// The sRGB transfer function (IEC 61966-2-1) and its inverse, on values in [0,1].
double srgb_from_linear(double linear);
double linear_from_srgb(double srgb);
float linear_from_srgb_byte(uint8_t srgb);    // by table
uint8_t srgb_byte_from_linear(float linear);  // the nearest, of [0,1] clamped; by table

constexpr uint32_t kMaxImageSide = 16384;

// Any PNG colour type and depth, widened to RGBA 8 bit. Throws InputError (missing, truncated, not a PNG, zero-size or
// beyond kMaxImageSide).
Image read_png(const std::filesystem::path& path);
// The same for PNG or JPEG bytes in memory; `name` stands for the file in errors.
Image decode_image(const uint8_t* bytes, size_t size, const std::string& name);

// Size of a PNG or JPEG file by its header alone: the rest may still be damaged.
struct ImageSize {
    uint32_t width = 0, height = 0;
    bool operator==(const ImageSize&) const = default;
};
ImageSize image_size(const std::filesystem::path& path);

// A PNG file's bytes: RGBA; where every pixel is opaque RGB, or grey where none has a colour. Throws RuntimeFailure.
std::vector<uint8_t> encode_png(const Image& image);
// The same as a file, atomically.
void write_png(const std::filesystem::path& path, const Image& image);

// The image over an opaque background (sRGB-encoded 0..255), blended in encoded values as image viewers and the NeRF
// family's metrics do; result is opaque.
Image composite_over(const Image& image, const uint8_t background_rgb[3]);

}  // namespace neuvv::media

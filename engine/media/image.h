// Images in memory, and as PNG and JPEG files. They are 8-bit, sRGB-encoded, with straight alpha, as image files are.
// Inside the engine light is linear and premultiplied; srgb.h has the transfer function for the conversion.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory_resource>
#include <vector>

#include "media/srgb.h"  // IWYU pragma: export

namespace neuvv::media {

// Row-major from the top left, 4 bytes per pixel: R, G, B sRGB-encoded, A straight.
struct Image {
    uint32_t width = 0;
    uint32_t height = 0;
    std::pmr::vector<uint8_t> rgba;  // its memory resource never changes, as for all vectors of std::pmr

    Image() = default;
    explicit Image(std::pmr::memory_resource* memory) : rgba(memory) {}
    Image(uint32_t w, uint32_t h) : width(w), height(h), rgba(size_t{4} * w * h) {}
    uint8_t* at(uint32_t x, uint32_t y) { return &rgba[(size_t{y} * width + x) * 4]; }
    const uint8_t* at(uint32_t x, uint32_t y) const { return &rgba[(size_t{y} * width + x) * 4]; }
};

constexpr uint32_t kMaxImageSide = 16384;

// Reads a PNG of any colour type and depth, converted to 8-bit RGBA. Throws InputError where the file is missing,
// truncated, no PNG, or where a side is 0 or beyond kMaxImageSide, and as expect_content() does.
Image read_png(const std::filesystem::path& path);
// The same for the bytes of a PNG or JPEG in memory; `name` stands for the file in errors.
Image decode_image(const uint8_t* bytes, size_t size, const std::string& name);

struct ImageSize {
    uint32_t width = 0, height = 0;
    bool operator==(const ImageSize&) const = default;
};

// Throws InputError for a large image in few bytes, which are less than any photograph or texture takes: files are
// untrusted, and a small one must not take gigabytes. For images of which nothing is known but their header.
void expect_content(ImageSize size, uint64_t bytes, const std::string& name);

// The bytes of a PNG: RGBA; RGB where every pixel is opaque; grey where every pixel is opaque and grey. Throws
// RuntimeFailure.
std::vector<uint8_t> encode_png(const Image& image);
// Writes the same as a file, atomically. Throws RuntimeFailure.
void write_png(const std::filesystem::path& path, const Image& image);

// The image over an opaque background (sRGB-encoded, 0 to 255). Encoded values are blended, as image viewers and the
// metrics of NeRF papers do. The result is opaque.
Image composite_over(const Image& image, const uint8_t background_rgb[3]);
inline constexpr uint8_t kWhite[3] = {255, 255, 255};

}  // namespace neuvv::media

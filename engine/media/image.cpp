#include "media/image.h"

#include <jpeglib.h>
// jerror.h needs jpeglib.h before it.
#include <fmt/format.h>
#include <jerror.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "base/platform.h"
#include "media/orientation.h"

namespace neuvv::media {

namespace {

constexpr uint64_t kMaxImageFileBytes = uint64_t{1} << 31;
constexpr uint64_t kMaxDeflateRatio = 1032;                 // no stream in zlib's format grows by more
constexpr uint64_t kLargeImage_pixels = uint64_t{1} << 25;  // 8K video has fewer
constexpr uint64_t kMaxPixelsPerByte = 256;                 // photographs have less than 20
constexpr int kMaxJpegScans = 200;                          // a progressive file with more scans is made to waste time
constexpr int kPngCompression = 4;  // with one filter: several times faster than the default, files slightly larger

constexpr uint8_t kPng[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr uint8_t kJpeg[3] = {0xff, 0xd8, 0xff};
constexpr int kExifMarker = JPEG_APP0 + 1;
constexpr unsigned kMaxMarkerBytes = 0xffff;
constexpr uint8_t kExif[6] = {'E', 'x', 'i', 'f', 0, 0};  // before the TIFF structure

// libpng and libjpeg report errors by longjmp, which skips destructors. So functions below that call setjmp have local
// variables of plain types only, and their callers own what must be freed.
struct PngReader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    const uint8_t* at = nullptr;
    size_t left = 0;
    char message[128] = "out of memory";

    PngReader() = default;
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct PngWriter {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::vector<uint8_t> bytes;
    char message[128] = "out of memory";

    PngWriter() = default;
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
    ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

void on_png_error(png_structp png, png_const_charp text) {
    std::snprintf(static_cast<char*>(png_get_error_ptr(png)), sizeof(PngReader::message), "%s", text);
    png_longjmp(png, 1);
}

void on_png_warning(png_structp, png_const_charp) {}

void pull_png_bytes(png_structp png, png_bytep to, size_t bytes) {
    auto& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (bytes > reader.left) png_error(png, "the file ends too early");
    std::memcpy(to, reader.at, bytes);
    reader.at += bytes;
    reader.left -= bytes;
}

void push_png_bytes(png_structp png, png_bytep from, size_t bytes) {
    auto& out = static_cast<PngWriter*>(png_get_io_ptr(png))->bytes;
    bool stored = true;
    try {
        out.insert(out.end(), from, from + bytes);
    } catch (...) {  // must not unwind through libpng
        stored = false;
    }
    if (!stored) png_error(png, "out of memory");
}

// Sets up the conversion of any PNG to 8-bit RGBA. Returns the bytes per row, 0 on an error.
size_t begin_png(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png))) return 0;
    png_set_user_limits(reader.png, kMaxImageSide, kMaxImageSide);
    png_set_read_fn(reader.png, &reader, pull_png_bytes);
    png_read_info(reader.png, reader.info);
    png_set_expand(reader.png);    // palettes, greys below 8 bit, transparent colours
    png_set_scale_16(reader.png);  // rounds where strip_16 truncates; no gamma involved
    png_set_gray_to_rgb(reader.png);
    png_set_add_alpha(reader.png, 0xff, PNG_FILLER_AFTER);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    return png_get_rowbytes(reader.png, reader.info);
}

bool finish_png(PngReader& reader, png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

uint32_t big_endian_32(const uint8_t* at) {
    return uint32_t{at[0]} << 24 | uint32_t{at[1]} << 16 | uint32_t{at[2]} << 8 | at[3];
}

void check_size(uint64_t width, uint64_t height, const std::string& name) {
    if (width == 0 || height == 0)
        throw InputError(name, "", fmt::format("the image has zero size ({}×{})", width, height));
    if (width > kMaxImageSide || height > kMaxImageSide)
        throw InputError(name, "", fmt::format("the image is {}×{}, more than {} a side", width, height, kMaxImageSide),
                         "scale it down");
}

// An image of the size that the header claims. Throws InputError before anything is allocated where the file is too
// small for that size.
Image allocate_for_png(const uint8_t* bytes, size_t size, const std::string& name) {
    if (size < 33 || std::memcmp(bytes + 12, "IHDR", 4) != 0)
        throw InputError(name, "IHDR", "truncated or damaged PNG", "export the image again");
    const uint32_t width = big_endian_32(bytes + 16), height = big_endian_32(bytes + 20);
    check_size(width, height, name);
    constexpr uint64_t kChannels[7] = {1, 0, 3, 1, 2, 0, 4};
    const uint64_t depth = bytes[24], channels = bytes[25] < 7 ? kChannels[bytes[25]] : 0;
    const uint64_t raw_bytes = height * ((width * channels * depth + 7) / 8);
    if (raw_bytes / kMaxDeflateRatio > size)
        throw InputError(name, "IHDR", fmt::format("truncated PNG: {} bytes cannot hold {}×{}", size, width, height),
                         "export the image again");
    return Image(width, height);
}

Image decode_png(const uint8_t* bytes, size_t size, const std::string& name) {
    Image image = allocate_for_png(bytes, size, name);
    PngReader reader;
    reader.at = bytes;
    reader.left = size;
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, reader.message, on_png_error, on_png_warning);
    if (reader.png) reader.info = png_create_info_struct(reader.png);
    std::vector<png_bytep> rows(image.height);
    for (uint32_t y = 0; y < image.height; ++y) rows[y] = image.at(0, y);
    if (!reader.info || begin_png(reader) != size_t{4} * image.width || !finish_png(reader, rows.data()))
        throw InputError(name, "", fmt::format("damaged PNG: {}", reader.message), "export the image again");
    return image;
}

struct JpegReader {
    jpeg_decompress_struct info{};
    jpeg_error_mgr errors{};
    jpeg_progress_mgr progress{};
    jmp_buf jump{};
    char message[JMSG_LENGTH_MAX] = "";

    JpegReader() = default;
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() { jpeg_destroy_decompress(&info); }
};

void on_jpeg_error(j_common_ptr info) {
    auto& reader = *static_cast<JpegReader*>(info->client_data);
    reader.errors.format_message(info, reader.message);
    longjmp(reader.jump, 1);
}

// libjpeg fills what a truncated file lacks with grey and warns; here that is an error.
void on_jpeg_message(j_common_ptr info, int level) {
    const int code = info->err->msg_code;
    if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) on_jpeg_error(info);
}

void on_jpeg_progress(j_common_ptr info) {
    auto& reader = *static_cast<JpegReader*>(info->client_data);
    if (reader.info.input_scan_number <= kMaxJpegScans) return;
    std::snprintf(reader.message, sizeof(reader.message), "more than %d scans", kMaxJpegScans);
    longjmp(reader.jump, 1);
}

bool begin_jpeg(JpegReader& reader, const uint8_t* bytes, size_t size) {
    reader.info.err = jpeg_std_error(&reader.errors);
    reader.errors.error_exit = on_jpeg_error;
    reader.errors.emit_message = on_jpeg_message;
    reader.info.client_data = &reader;
    if (setjmp(reader.jump)) return false;
    jpeg_create_decompress(&reader.info);  // keeps err and client_data
    reader.progress.progress_monitor = on_jpeg_progress;
    reader.info.progress = &reader.progress;
    jpeg_mem_src(&reader.info, bytes, static_cast<unsigned long>(size));
    jpeg_read_header(&reader.info, TRUE);
    reader.info.out_color_space = JCS_EXT_RGBA;
    return true;
}

// Reads a JPEG's header, with Exif; false where it has none.
bool read_jpeg_header(JpegReader& reader, std::FILE* file) {
    reader.info.err = jpeg_std_error(&reader.errors);
    reader.errors.error_exit = on_jpeg_error;
    reader.errors.emit_message = on_jpeg_message;
    reader.info.client_data = &reader;
    if (setjmp(reader.jump)) return false;
    jpeg_create_decompress(&reader.info);
    jpeg_stdio_src(&reader.info, file);
    jpeg_save_markers(&reader.info, kExifMarker, kMaxMarkerBytes);
    jpeg_read_header(&reader.info, TRUE);
    return true;
}

ImageHeader jpeg_header(std::FILE* file, const std::string& name) {
    JpegReader reader;
    if (!read_jpeg_header(reader, file))
        throw InputError(name, "", fmt::format("damaged or unsupported JPEG: {}", reader.message),
                         "export the image again, as RGB or grey");
    ImageHeader header{{reader.info.image_width, reader.info.image_height}};
    for (const jpeg_marker_struct* marker = reader.info.marker_list; marker; marker = marker->next)
        if (marker->marker == kExifMarker && marker->data_length >= sizeof(kExif) &&
            std::memcmp(marker->data, kExif, sizeof(kExif)) == 0)
            header.orientation = exif_orientation(marker->data + sizeof(kExif), marker->data_length - sizeof(kExif));
    return header;
}

// The size, and the Exif of a chunk before the pixels.
ImageHeader png_header(std::FILE* file, const std::string& name) {
    ImageHeader header;
    bool has_size = false;
    uint8_t chunk[8];
    std::vector<uint8_t> data;
    while (std::fread(chunk, 1, sizeof(chunk), file) == sizeof(chunk) && std::memcmp(chunk + 4, "IDAT", 4) != 0) {
        const uint32_t bytes = big_endian_32(chunk);
        const bool is_header = std::memcmp(chunk + 4, "IHDR", 4) == 0, is_exif = std::memcmp(chunk + 4, "eXIf", 4) == 0;
        data.resize((is_header || is_exif) && bytes <= kMaxMarkerBytes ? bytes : 0);
        if (std::fread(data.data(), 1, data.size(), file) != data.size()) break;
        if (is_header && data.size() >= 8) {
            header.stored = {big_endian_32(&data[0]), big_endian_32(&data[4])};
            has_size = true;
        }
        if (is_exif) header.orientation = exif_orientation(data.data(), data.size());
        if (std::fseek(file, static_cast<long>(bytes - data.size()) + 4, SEEK_CUR) != 0) break;
    }
    if (!has_size) throw InputError(name, "IHDR", "truncated or damaged PNG", "export the image again");
    return header;
}

using OwnedFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

ImageHeader header_of(std::FILE* file, const std::string& name) {
    uint8_t start[sizeof(kPng)] = {};
    const size_t got = std::fread(start, 1, sizeof(start), file);
    ImageHeader header;
    if (got == sizeof(start) && std::memcmp(start, kPng, sizeof(kPng)) == 0) {
        header = png_header(file, name);
    } else if (got == sizeof(start) && std::memcmp(start, kJpeg, sizeof(kJpeg)) == 0) {
        std::rewind(file);
        header = jpeg_header(file, name);
    } else {
        throw InputError(name, "", got == 0 ? "the file is empty or no file" : "is neither a PNG nor a JPEG",
                         "convert the image to PNG");
    }
    check_size(header.stored.width, header.stored.height, name);
    return header;
}

bool finish_jpeg(JpegReader& reader, uint8_t* rgba) {
    if (setjmp(reader.jump)) return false;
    jpeg_start_decompress(&reader.info);
    while (reader.info.output_scanline < reader.info.output_height) {
        JSAMPROW row = rgba + size_t{4} * reader.info.output_width * reader.info.output_scanline;
        jpeg_read_scanlines(&reader.info, &row, 1);
    }
    jpeg_finish_decompress(&reader.info);
    return true;
}

Image decode_jpeg(const uint8_t* bytes, size_t size, const std::string& name) {
    JpegReader reader;
    Image image;
    bool good = begin_jpeg(reader, bytes, size);
    if (good) {
        check_size(reader.info.image_width, reader.info.image_height, name);
        image = Image(reader.info.image_width, reader.info.image_height);
        good = finish_jpeg(reader, image.rgba.data());
    }
    if (!good)
        throw InputError(name, "", fmt::format("damaged or unsupported JPEG: {}", reader.message),
                         "export the image again, as RGB or grey");
    return image;
}

// `pixels` are RGBA, or one byte each for a grey image. An RGB image drops the alpha of RGBA pixels.
bool fill_png(PngWriter& writer, uint32_t width, uint32_t height, const uint8_t* pixels, int colour_type) {
    if (setjmp(png_jmpbuf(writer.png))) return false;
    png_set_write_fn(writer.png, &writer, push_png_bytes, nullptr);
    png_set_user_limits(writer.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(writer.png, writer.info, width, height, 8, colour_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_compression_level(writer.png, kPngCompression);
    png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_write_info(writer.png, writer.info);
    if (colour_type == PNG_COLOR_TYPE_RGB) png_set_filler(writer.png, 0, PNG_FILLER_AFTER);
    const size_t stride = size_t{width} * (colour_type == PNG_COLOR_TYPE_GRAY ? 1 : 4);
    for (uint32_t y = 0; y < height; ++y) png_write_row(writer.png, pixels + stride * y);
    png_write_end(writer.png, nullptr);
    return true;
}

}  // namespace

Image decode_image(const uint8_t* bytes, size_t size, const std::string& name) {
    if (size >= sizeof(kPng) && std::memcmp(bytes, kPng, sizeof(kPng)) == 0) return decode_png(bytes, size, name);
    if (size >= sizeof(kJpeg) && std::memcmp(bytes, kJpeg, sizeof(kJpeg)) == 0) return decode_jpeg(bytes, size, name);
    throw InputError(name, "", size == 0 ? "the file is empty" : "is neither a PNG nor a JPEG",
                     "convert the image to PNG");
}

ImageHeader image_header(const std::filesystem::path& path) {
    expect_regular_file(path);
    const OwnedFile file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) throw InputError(path.string(), "", fmt::format("cannot open: {}", std::strerror(errno)));
    return header_of(file.get(), path.string());
}

ImageHeader image_header(const uint8_t* bytes, size_t size, const std::string& name) {
    if (size == 0) throw InputError(name, "", "the file is empty", "convert the image to PNG");
    // It is only read.
    const OwnedFile file(fmemopen(const_cast<uint8_t*>(bytes), size, "rb"), std::fclose);
    if (!file) throw std::bad_alloc();
    return header_of(file.get(), name);
}

void expect_content(ImageSize size, uint64_t bytes, const std::string& name) {
    const uint64_t pixels = uint64_t{size.width} * size.height;
    if (pixels > kLargeImage_pixels && pixels / kMaxPixelsPerByte > bytes)
        throw InputError(
            name, "", fmt::format("is {}×{} in {} bytes, as no image of anything is", size.width, size.height, bytes),
            "scale it down");
}

Image read_png(const std::filesystem::path& path) {
    const std::vector<uint8_t> bytes = read_file(path, kMaxImageFileBytes);
    if (bytes.size() >= 2 && bytes[0] == 0xff && bytes[1] == 0xd8)
        throw InputError(path.string(), "", "is a JPEG, not a PNG", "convert the image to PNG");
    expect_content(image_header(bytes.data(), bytes.size(), path.string()).stored, bytes.size(), path.string());
    return decode_image(bytes.data(), bytes.size(), path.string());
}

std::vector<uint8_t> encode_png(const Image& image) {
    assert(image.width > 0 && image.height > 0 && "an image to write has pixels");
    assert(image.rgba.size() == size_t{4} * image.width * image.height && "four bytes a pixel");
    bool opaque = true, grey = true;
    for (size_t i = 0; i < image.rgba.size() && opaque; i += 4) {
        opaque = image.rgba[i + 3] == 255;
        grey = grey && image.rgba[i] == image.rgba[i + 1] && image.rgba[i] == image.rgba[i + 2];
    }
    std::vector<uint8_t> values;
    if (opaque && grey)
        for (size_t i = 0; i < image.rgba.size(); i += 4) values.push_back(image.rgba[i]);
    const int type = !opaque ? PNG_COLOR_TYPE_RGB_ALPHA : grey ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB;
    PngWriter writer;
    writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, writer.message, on_png_error, on_png_warning);
    if (writer.png) writer.info = png_create_info_struct(writer.png);
    if (!writer.info ||
        !fill_png(writer, image.width, image.height, values.empty() ? image.rgba.data() : values.data(), type))
        throw RuntimeFailure(fmt::format("cannot encode a PNG: {}", writer.message));
    return std::move(writer.bytes);
}

void write_png(const std::filesystem::path& path, const Image& image) {
    const std::vector<uint8_t> bytes = encode_png(image);
    write_file_atomically(path, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

Image composite_over(const Image& image, const uint8_t background_rgb[3]) {
    Image result(image.width, image.height);
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        const uint32_t alpha = image.rgba[i + 3];
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t sum = image.rgba[i + c] * alpha + background_rgb[c] * (255 - alpha);
            result.rgba[i + c] = static_cast<uint8_t>((sum + 127) / 255);
        }
        result.rgba[i + 3] = 255;
    }
    return result;
}

}  // namespace neuvv::media

#include "media/jpeg.h"

// jpeglib.h needs it before.
#include <cstdio>

#include <jpeglib.h>

#include <fmt/format.h>

#include <cassert>
#include <csetjmp>
#include <cstdlib>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::media {

namespace {

// libjpeg reports errors by longjmp, which skips destructors: fill_jpeg() has local variables of plain types only.
struct JpegWriter {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    jmp_buf jump;
    unsigned char* bytes = nullptr;  // of malloc
    unsigned long size = 0;
    char message[JMSG_LENGTH_MAX] = "";

    JpegWriter() = default;
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;
    ~JpegWriter() {
        jpeg_destroy_compress(&info);
        std::free(bytes);
    }
};

void on_jpeg_write_error(j_common_ptr info) {
    auto& writer = *static_cast<JpegWriter*>(info->client_data);
    writer.errors.format_message(info, writer.message);
    longjmp(writer.jump, 1);
}

bool fill_jpeg(JpegWriter& writer, const Image& image, int quality) {
    writer.info.err = jpeg_std_error(&writer.errors);
    writer.errors.error_exit = on_jpeg_write_error;
    writer.info.client_data = &writer;
    if (setjmp(writer.jump)) return false;
    jpeg_create_compress(&writer.info);  // keeps err and client_data
    jpeg_mem_dest(&writer.info, &writer.bytes, &writer.size);
    writer.info.image_width = image.width;
    writer.info.image_height = image.height;
    writer.info.input_components = 4;
    writer.info.in_color_space = JCS_EXT_RGBX;
    jpeg_set_defaults(&writer.info);
    jpeg_set_quality(&writer.info, quality, TRUE);
    jpeg_start_compress(&writer.info, TRUE);
    while (writer.info.next_scanline < image.height) {
        // libjpeg only reads the row.
        JSAMPROW row = const_cast<uint8_t*>(image.at(0, writer.info.next_scanline));
        jpeg_write_scanlines(&writer.info, &row, 1);
    }
    jpeg_finish_compress(&writer.info);
    return true;
}

}  // namespace

std::vector<uint8_t> encode_jpeg(const Image& image, int quality) {
    assert(image.width > 0 && image.height > 0 && "an image to write has pixels");
    assert(image.rgba.size() == size_t{4} * image.width * image.height && "four bytes a pixel");
    assert(quality >= 1 && quality <= 100 && "libjpeg's quality");
    JpegWriter writer;
    if (!fill_jpeg(writer, image, quality))
        throw RuntimeFailure(fmt::format("cannot encode a JPEG: {}", writer.message));
    return {writer.bytes, writer.bytes + writer.size};
}

void write_jpeg(const std::filesystem::path& path, const Image& image, int quality) {
    const std::vector<uint8_t> bytes = encode_jpeg(image, quality);
    write_file_atomically(path, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

}  // namespace neuvv::media

// JPEG files with Exif.
#pragma once

// jpeglib.h needs it before.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <jpeglib.h>

namespace neuvv::test {

// Little- or big-endian Exif with one other tag before the orientation.
inline std::string exif(int orientation, bool big) {
    const auto number = [&](uint32_t value, int bytes) {
        std::string text;
        for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * (big ? bytes - 1 - i : i));
        return text;
    };
    return std::string(big ? "MM" : "II") + number(42, 2) + number(8, 4) + number(2, 2) + number(0x100, 2) +
           number(4, 2) + number(1, 4) + number(1, 4) + number(0x112, 2) + number(3, 2) + number(1, 4) +
           number(static_cast<uint32_t>(orientation), 2) + number(0, 2) + number(0, 4);
}

// A grey JPEG, with Exif where data are given.
inline std::string jpeg(const std::string& exif_data, uint32_t width = 16, uint32_t height = 8) {
    jpeg_compress_struct info;
    jpeg_error_mgr errors;
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &bytes, &size);
    info.image_width = width;
    info.image_height = height;
    info.input_components = 1;
    info.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&info);
    jpeg_start_compress(&info, TRUE);
    const std::string marker = std::string("Exif\0\0", 6) + exif_data;
    if (!exif_data.empty())
        jpeg_write_marker(&info, JPEG_APP0 + 1, reinterpret_cast<const JOCTET*>(marker.data()),
                          static_cast<unsigned>(marker.size()));
    std::vector<uint8_t> row(width, 100);
    JSAMPROW rows = row.data();
    while (info.next_scanline < info.image_height) jpeg_write_scanlines(&info, &rows, 1);
    jpeg_finish_compress(&info);
    const std::string file(reinterpret_cast<char*>(bytes), size);
    jpeg_destroy_compress(&info);
    std::free(bytes);
    return file;
}

}  // namespace neuvv::test

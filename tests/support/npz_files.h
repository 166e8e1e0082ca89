// Writes .npz files as NumPy does, and damaged ones.
#pragma once

#include <gtest/gtest.h>
#include <zip.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace neuvv::test {

// An array in version 1 of the format. The size of `numbers` need not fit type and shape.
inline std::string npy_bytes(const std::string& type, const std::vector<uint64_t>& shape, const std::string& numbers,
                             const std::string& fortran_order = "False") {
    std::string sides;
    for (const uint64_t side : shape) sides += std::to_string(side) + ", ";
    std::string header =
        "{'descr': '" + type + "', 'fortran_order': " + fortran_order + ", 'shape': (" + sides + "), }";
    header.resize((header.size() + 10 + 64) / 64 * 64 - 10, ' ');
    header.back() = '\n';
    std::string bytes = "\x93NUMPY";
    bytes += {1, 0, static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
    return bytes + header + numbers;
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// numpy.savez stores arrays uncompressed (ZIP_CM_STORE), savez_compressed uses ZIP_CM_DEFLATE.
inline void write_npz(const std::filesystem::path& file, const std::map<std::string, std::string>& arrays,
                      int32_t method = ZIP_CM_STORE) {
    int error = 0;
    zip_t* zip = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
    ASSERT_NE(zip, nullptr);
    for (const auto& [name, bytes] : arrays) {
        const zip_int64_t index =
            zip_file_add(zip, (name + ".npy").c_str(), zip_source_buffer(zip, bytes.data(), bytes.size(), 0), 0);
        ASSERT_GE(index, 0);
        ASSERT_EQ(zip_set_file_compression(zip, static_cast<zip_uint64_t>(index), method, 0), 0);
    }
    ASSERT_EQ(zip_close(zip), 0);
}

}  // namespace neuvv::test

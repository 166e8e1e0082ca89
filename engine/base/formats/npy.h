// NumPy's .npy files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace neuvv {

// The header of a .npy. The numbers of its array are the rest of its bytes, row by row.
struct NpyHeader {
    std::string type;             // NumPy's: "<f2", "<i4", "|u1", "<U4" (UTF-32), ...
    std::vector<uint64_t> shape;  // outermost first; empty: one number
    uint64_t count = 1;           // how many numbers: the product of the shape
    size_t begin = 0;             // the offset of the first number, bytes
};
// Parses the header of a .npy of version 1 to 3 whose array has little-endian numbers or text in C order. Throws
// InputError with `file` and `place` for anything else, pickled objects included, and where the file has more or fewer
// bytes than the shape requires.
NpyHeader parse_npy_header(const std::vector<uint8_t>& bytes, const std::string& file, const std::string& place);

struct NpyArray {
    std::vector<uint64_t> shape;  // may be empty: one number
    std::vector<double> values;   // row by row
};

// Reads an array of floating-point numbers, f4 or f8. Throws InputError as above.
NpyArray read_npy(const std::filesystem::path& file);
// The same for the bytes of a .npy inside another file; `place` says where, for errors.
NpyArray parse_npy(const std::vector<uint8_t>& bytes, const std::string& file, const std::string& place);

}  // namespace neuvv

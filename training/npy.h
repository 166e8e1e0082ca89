// NumPy's .npy files of floating-point numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace neuvv {

struct NpyArray {
    std::vector<uint64_t> shape;  // may be empty: one number
    std::vector<double> values;   // row by row
};

// Versions 1 to 3 of the format, little-endian f4 or f8 in C order. Throws InputError naming the file for anything
// else, pickled objects included, and where the file is shorter or longer than its shape.
NpyArray read_npy(const std::filesystem::path& file);
// Its bytes out of another file; `place` says where, for errors.
NpyArray parse_npy(const std::vector<uint8_t>& bytes, const std::string& file, const std::string& place);

}  // namespace neuvv

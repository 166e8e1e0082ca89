// NumPy's .npz: a zip file of arrays, as numpy.savez and savez_compressed write it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace neuvv {

struct FloatArray {
    std::vector<uint64_t> shape;  // outermost first
    std::vector<float> values;    // as many as the shape says, the last index fastest
};

// Every array by its name, without ".npy". Throws InputError naming file and array: no zip file, a damaged or absurdly
// large one, an array that npy.h does not read.
std::map<std::string, FloatArray> read_npz(const std::filesystem::path& file);

}  // namespace neuvv

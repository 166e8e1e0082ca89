// Writes NumPy's .npz: a zip file of arrays, as numpy.savez_compressed writes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace neuvv {

struct NpzArray {
    std::string name;             // without ".npy"
    std::string type;             // NumPy's: "<f2", "<i4", "<U3" (UTF-32) …
    std::vector<uint64_t> shape;  // outermost first; empty: one number
    std::vector<uint8_t> bytes;   // as type and shape say, little-endian, row by row
};

// An array of one number or one ASCII text.
NpzArray npz_number(const std::string& name, int64_t number);
NpzArray npz_number(const std::string& name, double number);
NpzArray npz_text(const std::string& name, const std::string& text);
template <typename T>
NpzArray npz_array(const std::string& name, const std::string& type, std::vector<uint64_t> shape,
                   const std::vector<T>& numbers) {
    const auto* begin = reinterpret_cast<const uint8_t*>(numbers.data());
    return {name, type, std::move(shape), {begin, begin + numbers.size() * sizeof(T)}};
}

// Writes the file atomically. Throws RuntimeFailure where it cannot be written.
void write_npz(const std::filesystem::path& file, const std::vector<NpzArray>& arrays);

}  // namespace neuvv

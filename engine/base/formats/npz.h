// NumPy's .npz: a zip file of arrays, as numpy.savez and savez_compressed write it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

struct zip;  // libzip's

namespace neuvv {

// An open .npz, whose arrays are read into memory one by one. All functions throw InputError with file and array.
class NpzReader {
  public:
    // Throws for a file that is no zip file, and for one that unpacks to more than 64 MiB plus 128 times its size.
    explicit NpzReader(const std::filesystem::path& file);

    std::vector<std::string> names() const;  // without ".npy"
    bool has(const std::string& name) const { return entries_.contains(name); }
    // The array as a .npy (npy.h), with its checksum verified. Throws where the array is missing.
    std::vector<uint8_t> bytes(const std::string& name) const;

  private:
    struct Entry {
        uint64_t index, bytes, packed_bytes;
        uint32_t checksum;
        bool deflated;  // and not encrypted
    };
    std::vector<uint8_t> inflated(const Entry& entry, const std::string& name) const;
    std::string file_;
    std::unique_ptr<zip, void (*)(zip*)> zip_;
    std::map<std::string, Entry> entries_;
};

struct FloatArray {
    std::vector<uint64_t> shape;  // outermost first
    std::vector<float> values;    // as many as the shape says, the last index fastest
};

// Reads all arrays of an .npz of f4 and f8, by name. Throws InputError as above.
std::map<std::string, FloatArray> read_npz(const std::filesystem::path& file);

}  // namespace neuvv

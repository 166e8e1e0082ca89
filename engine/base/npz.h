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

// One open .npz, an array in memory at a time. All throw InputError naming file and array.
class NpzReader {
  public:
    // Refuses what is no zip file, and what unpacks to more than 64 MiB and 128 times the file's size in all.
    explicit NpzReader(const std::filesystem::path& file);

    std::vector<std::string> names() const;  // without ".npy"
    bool has(const std::string& name) const { return entries_.contains(name); }
    // The array as a .npy (npy.h), its checksum verified. Arrays that are missing throw, too.
    std::vector<uint8_t> bytes(const std::string& name) const;

  private:
    struct Entry {
        uint64_t index, bytes;
    };
    std::string file_;
    std::unique_ptr<zip, void (*)(zip*)> zip_;
    std::map<std::string, Entry> entries_;
};

struct FloatArray {
    std::vector<uint64_t> shape;  // outermost first
    std::vector<float> values;    // as many as the shape says, the last index fastest
};

// Every array of an .npz of f4 and f8 by its name. Throws InputError as above.
std::map<std::string, FloatArray> read_npz(const std::filesystem::path& file);

}  // namespace neuvv

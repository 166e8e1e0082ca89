// The arrays of a PlenOctree's file: an .npz of svox' N3Tree, or what volrend's compression makes of one.
#pragma once

#include <cstring>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/formats/npy.h"
#include "base/formats/npz.h"

namespace neuvv::voctree {

// An array of the file, whose numbers are read as they are needed.
struct PlenoctreeArray {
    NpyHeader header;
    std::vector<uint8_t> bytes;

    // The number of an index in row order; T must have the array's type, and the index must lie in it.
    template <typename T>
    T at(uint64_t index) const {
        T value;
        std::memcpy(&value, &bytes[header.begin + index * sizeof(T)], sizeof(T));
        return value;
    }
    uint64_t side(size_t axis) const { return header.shape[axis]; }
};

// How a leaf's numbers make colours: first those of R, then of G, then of B.
struct PlenoctreeFormat {
    uint32_t numbers = 1;  // of each channel
    uint32_t degree = 0;   // of SH
    double scale = 1;      // from a number to an SH coefficient
};

struct PlenoctreeBox {
    glm::vec3 min, size;  // in the file's units and axes
};

// A PlenOctree in memory. The number of a cell is 8 · node + 4 x + 2 y + z. Functions throw InputError with the file,
// the place in it, and the fix.
class PlenoctreeFile {
  public:
    // Reads the nodes. Throws for what is damaged, and for trees in NDC.
    explicit PlenoctreeFile(const std::filesystem::path& path);
    // Reads the numbers of the leaves, which most time goes to: meanwhile another thread may walk over the nodes.
    // Throws for what is damaged or of a format that is not read.
    void read_numbers();

    const std::string& name() const { return name_; }
    uint64_t nodes() const { return child_.side(0); }
    const PlenoctreeBox& box() const { return box_; }

    // From a cell's node to the node below the cell; 0: the cell is a leaf. Not checked.
    int32_t child(uint64_t cell) const { return child_.at<int32_t>(cell); }

    // What follows needs the numbers (assert).
    const PlenoctreeFormat& format() const { return format_; }
    // As it is stored: negative and infinite ones, too. Throws for NaN.
    float sigma(uint64_t cell) const;
    // Writes the 3 · format().numbers numbers of a leaf. Throws where one is not finite, or beyond all use.
    void colours(uint64_t cell, float* to) const;
    // "child[4, 0, 1, 0]", for errors.
    static std::string place(const char* array, uint64_t cell);

  private:
    void read_whole();
    void read_quantised();
    void expect_cells(const PlenoctreeArray& array, const char* array_name, const char* type, uint64_t before,
                      uint64_t behind) const;
    float quantised_number(uint64_t cell, uint64_t channel, uint64_t i) const;

    std::string name_;
    NpzReader npz_;
    PlenoctreeBox box_;
    PlenoctreeFormat format_;
    PlenoctreeArray child_;
    // Where it is not quantised: a leaf's colours, then its density.
    PlenoctreeArray data_;
    bool halves_ = true;  // else floats
    uint64_t row_ = 0;    // numbers of a leaf
    // Where it is: the first `retained_count_` numbers of each channel as they were, by number, cell and channel; the
    // other ones by number, as indices of a palette's colours, by cell; and the densities.
    bool quantised_ = false;
    uint64_t retained_count_ = 0;
    PlenoctreeArray retained_, indices_, palettes_, sigma_;
};

// Reads the box alone. Throws InputError as above.
PlenoctreeBox read_box_of_file(const std::filesystem::path& path);

}  // namespace neuvv::voctree

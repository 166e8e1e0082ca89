#include "voctree/plenoctree.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "base/error.h"
#include "base/npy.h"
#include "base/npz.h"
#include "base/parallel.h"
#include "voctree/decode_colours.h"
#include "voctree/half.h"
#include "voctree/sh_weights.h"

namespace neuvv::voctree {

namespace {

constexpr uint32_t kMaxDepth = 2 * kMaxNodeLevels;
constexpr double kY00 = 0.28209479177387814;
constexpr const char* kFix = "write it with N3Tree.save of svox";

// An array of the file, with its header.
struct RawArray {
    NpyHeader header;
    std::vector<uint8_t> bytes;

    template <typename T>
    T at(uint64_t index) const {
        T value;
        std::memcpy(&value, &bytes[header.begin + index * sizeof(T)], sizeof(T));
        return value;
    }
};

RawArray read_array(const NpzReader& npz, const std::string& file, const char* name) {
    if (!npz.has(name)) throw InputError(file, name, "is missing: this is no PlenOctree", kFix);
    RawArray array;
    array.bytes = npz.bytes(name);
    array.header = parse_npy_header(array.bytes, file, name);
    return array;
}

glm::vec3 read_vec3(const NpzReader& npz, const std::string& file, const char* name) {
    const RawArray array = read_array(npz, file, name);
    if (array.header.type != "<f4" || array.header.count != 3)
        throw InputError(file, name, "is not three numbers of type <f4", kFix);
    return {array.at<float>(0), array.at<float>(1), array.at<float>(2)};
}

// svox: tree = offset + invradius3 · world.
PlenoctreeBox read_box(const NpzReader& npz, const std::string& file) {
    const glm::vec3 per_metre = read_vec3(npz, file, "invradius3"), offset = read_vec3(npz, file, "offset");
    const PlenoctreeBox box{-offset / per_metre, 1.0f / per_metre};
    for (int axis = 0; axis < 3; ++axis)
        if (!(per_metre[axis] > 0) || !std::isnormal(box.size[axis]) || !std::isfinite(box.min[axis]) ||
            !std::isfinite(box.min[axis] + box.size[axis]))
            throw InputError(file, "invradius3", "with offset it makes no box of finite size", kFix);
    return box;
}

// The format of a leaf's numbers: those of R, then G, then B, then σ.
struct Format {
    uint32_t numbers = 0;  // of each channel
    uint32_t degree = 0;   // of SH
    double scale = 1;      // from a number to an SH coefficient
};

Format format_of(const std::string& name, const std::string& file) {
    if (name == "RGBA") return {1, 0, 1 / kY00};
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree)
        if (name == fmt::format("SH{}", sh_count(degree))) return {sh_count(degree), degree, 1};
    throw InputError(file, "data_format", fmt::format("is {}, not RGBA, SH1, SH4, SH9 or SH16", name),
                     "convert it with svox, or extract the tree anew");
}

// The name of the format. Files of svox' first versions do not have it, so it is derived from the numbers of a leaf.
std::string format_name(const NpzReader& npz, const std::string& file, uint64_t data_dim) {
    if (!npz.has("data_format")) return data_dim == 4 ? "RGBA" : fmt::format("SH{}", (data_dim - 1) / 3);
    const RawArray text = read_array(npz, file, "data_format");
    if (!text.header.type.starts_with("<U") || text.header.count != 1)
        throw InputError(file, "data_format", "is no text", kFix);
    std::string name;
    for (size_t at = text.header.begin; at + 4 <= text.bytes.size() && name.size() < 8; at += 4) {
        uint32_t letter = 0;
        std::memcpy(&letter, &text.bytes[at], 4);
        if (letter != 0) name += letter > ' ' && letter < 127 ? static_cast<char>(letter) : '?';
    }
    return name;
}

class Plenoctree {
  public:
    Plenoctree(const NpzReader& npz, const std::string& file) : file_(file) {
        if (npz.has("quant_colors"))
            throw InputError(file, "quant_colors", "its colours are quantised", "use the tree from before compression");
        child_ = read_array(npz, file, "child");
        data_ = read_array(npz, file, "data");
        const auto& of_child = child_.header.shape;
        const auto& of_data = data_.header.shape;
        if (child_.header.type != "<i4" || of_child.size() != 4 || of_child[0] == 0 || of_child[1] != 2 ||
            of_child[2] != 2 || of_child[3] != 2)
            throw InputError(file, "child", "is not of type <i4 and shape (nodes, 2, 2, 2)", kFix);
        halves_ = data_.header.type == "<f2";
        if ((!halves_ && data_.header.type != "<f4") || of_data.size() != 5 ||
            !std::equal(of_child.begin(), of_child.end(), of_data.begin()) || of_data[4] < 4)
            throw InputError(file, "data", "is not of type <f2 or <f4 and shape (nodes, 2, 2, 2, numbers)", kFix);
        numbers_ = of_data[4];
        format_ = format_of(format_name(npz, file, numbers_), file);
        if (numbers_ != 3 * format_.numbers + 1)
            throw InputError(file, "data_format", fmt::format("does not fit {} numbers a leaf", numbers_), kFix);
        reached_.resize(of_child[0]);
        reached_[0] = true;
        visit(0, {0, 0, 0, 0});
        if (positions_.empty()) throw InputError(file, "data", "is empty everywhere", "extract the tree anew");
    }

    VOctree tree(PlenoctreeColours colours) const {
        VOctree tree;
        tree.node_levels = (deepest_ + 1) / 2;
        make_still(tree, format_.degree);
        build_topology(tree, positions_);
        const ColourDecoder decoder(format_.degree);
        parallel_for(positions_.size(), 4096, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) fill_leaf(tree, i, colours, decoder);
        });
        return tree;
    }

  private:
    std::string file_;
    RawArray child_, data_;
    bool halves_ = true;
    uint64_t numbers_ = 0;  // of a leaf
    Format format_;
    std::vector<bool> reached_;            // nodes that the walk has reached
    std::vector<LeafPosition> positions_;  // of leaves with σ > 0
    std::vector<uint64_t> cells_;          // the indices of these leaves in `data`
    uint32_t deepest_ = 1;

    std::string name_of(const char* array, uint64_t cell) const {
        return fmt::format("{}[{}, {}, {}, {}]", array, cell / 8, cell >> 2 & 1, cell >> 1 & 1, cell & 1);
    }

    float number(uint64_t cell, uint64_t i) const {
        const uint64_t index = cell * numbers_ + i;
        const float value = halves_ ? float_from_half(data_.at<uint16_t>(index)) : data_.at<float>(index);
        if (!std::isfinite(value))
            throw InputError(file_, name_of("data", cell), fmt::format("number {} is not finite", i),
                             "extract the tree anew");
        return value;
    }

    // Adds the leaves below a node in the order of a VOctree's cells, where z is the highest bit of a cell's number; in
    // the file it is the lowest. The recursion is at most kMaxDepth deep, because child_of refuses deeper nodes.
    void visit(uint64_t node, const LeafPosition& position) {
        for (uint32_t i = 0; i < 8; ++i) {
            const uint32_t x = i & 1, y = i >> 1 & 1, z = i >> 2;
            const uint64_t cell = 8 * node + 4 * x + 2 * y + z;
            const LeafPosition at{2 * position.x + x, 2 * position.y + y, 2 * position.z + z, position.depth + 1};
            if (child_.at<int32_t>(cell) == 0)
                add_leaf(cell, at);
            else
                visit(child_of(node, cell, at.depth), at);
        }
    }

    uint64_t child_of(uint64_t node, uint64_t cell, uint32_t depth) {
        const auto fail = [&](const std::string& problem, const char* fix = kFix) {
            throw InputError(file_, name_of("child", cell), problem, fix);
        };
        const int64_t child = static_cast<int64_t>(node) + child_.at<int32_t>(cell);
        if (child < 0 || child >= static_cast<int64_t>(reached_.size()))
            fail(fmt::format("node {} does not exist ({} do)", child, reached_.size()));
        const auto index = static_cast<uint64_t>(child);
        if (reached_[index]) fail(fmt::format("node {} is reached more than once", child));
        if (depth == kMaxDepth)
            fail(fmt::format("leaves lie deeper than {} levels", kMaxDepth), "extract a coarser tree");
        reached_[index] = true;
        return index;
    }

    void add_leaf(uint64_t cell, const LeafPosition& position) {
        if (number(cell, numbers_ - 1) <= 0) return;
        if (positions_.size() == kMaxLeaves)
            throw InputError(file_, "child", fmt::format("has more than {} leaves", kMaxLeaves),
                             "extract a coarser tree");
        deepest_ = std::max(deepest_, position.depth);
        positions_.push_back(position);
        cells_.push_back(cell);
    }

    void fill_leaf(VOctree& tree, size_t leaf, PlenoctreeColours colours, const ColourDecoder& decoder) const {
        float* weights = tree.leaf(static_cast<uint32_t>(leaf));
        *weights++ = number(cells_[leaf], numbers_ - 1);
        *weights++ = 0;  // γ = π sigmoid(0)
        for (uint32_t channel = 0; channel < 3; ++channel) {
            ChannelSh k{};
            for (uint32_t i = 0; i < format_.numbers; ++i)
                k[i] = format_.scale * double{number(cells_[leaf], uint64_t{channel} * format_.numbers + i)};
            turn_signs(k);
            if (colours == PlenoctreeColours::kLinear) k = decoder.decode(k);
            const std::vector<float> numbers(k.begin(), k.end());
            write_sh(weights, format_.degree, numbers.data());
            weights += hh_count(format_.degree);
        }
    }

    // Converts coefficients to SH without the Condon-Shortley phase.
    static void turn_signs(ChannelSh& k) {
        for (int l = 0; l <= static_cast<int>(kMaxHhDegree); ++l)
            for (int m = -l; m <= l; ++m)
                if (m % 2 != 0) k[static_cast<size_t>(l * l + l + m)] *= -1;
    }
};

}  // namespace

VOctree read_plenoctree(const std::filesystem::path& path, PlenoctreeColours colours) {
    const std::string file = path.string();
    const NpzReader npz(path);
    const PlenoctreeBox box = read_box(npz, file);
    VOctree tree = Plenoctree(npz, file).tree(colours);
    tree.box_min = box.min;
    tree.box_size = box.size;
    if (const std::string defect = defect_of(tree); !defect.empty())
        throw InputError(file, "data", defect, "extract the tree anew");
    return tree;
}

PlenoctreeBox read_plenoctree_box(const std::filesystem::path& path) {
    return read_box(NpzReader(path), path.string());
}

}  // namespace neuvv::voctree

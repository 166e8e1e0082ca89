#include "voctree/files/plenoctree_file.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "base/error.h"
#include "shared/hh_counts.h"
#include "voctree/files/half.h"

namespace neuvv::voctree {

namespace {

constexpr double kY00 = 0.28209479177387814;
constexpr float kMostCoefficient = 1e9f;  // far beyond all that a sigmoid tells apart
constexpr const char *kFix = "write it with N3Tree.save of svox", *kExtractAnew = "extract the tree anew";

// volrend takes a tree for one in NDC where such a file is beside it; the tree itself does not say so.
void expect_no_ndc(const std::filesystem::path& path) {
    std::filesystem::path poses = path;
    poses.replace_filename(path.stem().string() + "_poses_bounds.npy");
    std::error_code error;
    if (std::filesystem::exists(poses, error))
        throw InputError(path.string(), "",
                         fmt::format("is a tree in NDC, the squeezed space of scenes that are seen from the front "
                                     "alone, as {} says",
                                     poses.filename().string()),
                         "extract a tree in world space; where that file does not belong to the tree, rename it");
}

NpzReader open_npz(const std::filesystem::path& path) {
    NpzReader npz(path);
    expect_no_ndc(path);
    return npz;
}

PlenoctreeArray read_array(const NpzReader& npz, const std::string& file, const char* name) {
    if (!npz.has(name)) throw InputError(file, name, "is missing: this is no PlenOctree", kFix);
    PlenoctreeArray array;
    array.bytes = npz.bytes(name);
    array.header = parse_npy_header(array.bytes, file, name);
    return array;
}

// One number is taken for each axis where only one is needed.
glm::dvec3 read_vec3(const NpzReader& npz, const std::string& file, const char* name, uint64_t count) {
    const PlenoctreeArray array = read_array(npz, file, name);
    const bool doubles = array.header.type == "<f8";
    if ((!doubles && array.header.type != "<f4") || array.header.count != count)
        throw InputError(
            file, name, fmt::format("is not {} of type <f4 or <f8", count == 1 ? "one number" : "three numbers"), kFix);
    glm::dvec3 v;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<uint64_t>(count == 1 ? 0 : axis);
        v[axis] = doubles ? array.at<double>(at) : double{array.at<float>(at)};
    }
    return v;
}

// svox: tree = offset + invradius3 · world. Before February 2021 it had one `invradius` for the three axes.
PlenoctreeBox read_box(const NpzReader& npz, const std::string& file) {
    const bool legacy = !npz.has("invradius3") && npz.has("invradius");
    const char* name = legacy ? "invradius" : "invradius3";
    const glm::vec3 per_metre(read_vec3(npz, file, name, legacy ? 1 : 3)), offset(read_vec3(npz, file, "offset", 3));
    const PlenoctreeBox box{-offset / per_metre, 1.0f / per_metre};
    for (int axis = 0; axis < 3; ++axis)
        if (!(per_metre[axis] > 0) || !std::isnormal(box.size[axis]) || !std::isfinite(box.min[axis]) ||
            !std::isfinite(box.min[axis] + box.size[axis]))
            throw InputError(file, name, "with offset it makes no box of finite size", kFix);
    return box;
}

PlenoctreeFormat format_of(const std::string& name, const std::string& file) {
    if (name == "RGBA") return {1, 0, 1 / kY00};
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree)
        if (name == fmt::format("SH{}", sh_count(degree))) return {sh_count(degree), degree, 1};
    throw InputError(file, "data_format", fmt::format("is {}, not RGBA, SH1, SH4, SH9 or SH16", name),
                     "convert it with svox, or extract the tree anew");
}

// The name of the format. Files of svox' first versions do not have it, so it is derived from the numbers of a leaf.
std::string format_name(const NpzReader& npz, const std::string& file, uint64_t numbers) {
    if (!npz.has("data_format")) return numbers == 4 ? "RGBA" : fmt::format("SH{}", (numbers - 1) / 3);
    const PlenoctreeArray text = read_array(npz, file, "data_format");
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

}  // namespace

PlenoctreeFile::PlenoctreeFile(const std::filesystem::path& path)
    : name_(path.string()), npz_(open_npz(path)), box_(read_box(npz_, name_)) {
    child_ = read_array(npz_, name_, "child");
    const auto& shape = child_.header.shape;
    if (child_.header.type != "<i4" || shape.size() != 4 || shape[0] == 0 || shape[1] != 2 || shape[2] != 2 ||
        shape[3] != 2)
        throw InputError(name_, "child", "is not of type <i4 and shape (nodes, 2, 2, 2)", kFix);
}

void PlenoctreeFile::read_numbers() {
    quantised_ = npz_.has("quant_colors");
    if (quantised_)
        read_quantised();
    else
        read_whole();
    format_ = format_of(format_name(npz_, name_, row_), name_);
    if (row_ != 3 * uint64_t{format_.numbers} + 1)
        throw InputError(name_, "data_format", fmt::format("does not fit {} numbers a leaf", row_), kFix);
}

void PlenoctreeFile::read_whole() {
    data_ = read_array(npz_, name_, "data");
    const auto& shape = data_.header.shape;
    halves_ = data_.header.type == "<f2";
    if ((!halves_ && data_.header.type != "<f4") || shape.size() != 5 ||
        !std::equal(shape.begin(), shape.end() - 1, child_.header.shape.begin()) || shape[4] < 4)
        throw InputError(name_, "data", "is not of type <f2 or <f4 and shape (nodes, 2, 2, 2, numbers)", kFix);
    row_ = shape[4];
}

// volrend's compress_octree.py: of each channel's numbers the first ones stay, and each of the others is, for all three
// channels together, one of the 65536 colours of a palette.
void PlenoctreeFile::read_quantised() {
    palettes_ = read_array(npz_, name_, "quant_colors");
    indices_ = read_array(npz_, name_, "quant_map");
    sigma_ = read_array(npz_, name_, "sigma");
    const auto& palettes = palettes_.header.shape;
    if (palettes_.header.type != "<f2" || palettes.size() != 3 || palettes[0] == 0 || palettes[1] == 0 ||
        palettes[2] != 3)
        throw InputError(name_, "quant_colors", "is not of type <f2 and shape (numbers, colours, 3)", kFix);
    expect_cells(indices_, "quant_map", "<u2", palettes[0], 0);
    expect_cells(sigma_, "sigma", "<f2", 0, 0);
    if (npz_.has("data_retained")) {
        retained_ = read_array(npz_, name_, "data_retained");
        retained_count_ = retained_.header.shape.empty() ? 0 : retained_.side(0);
        expect_cells(retained_, "data_retained", "<f2", retained_count_, 3);
    }
    row_ = 3 * (palettes[0] + retained_count_) + 1;
}

// Throws where an array is not of a type and has not a number for each cell; `before` numbers of other axes come before
// the cells, `behind` after them, 0 where there is no such axis.
void PlenoctreeFile::expect_cells(const PlenoctreeArray& array, const char* array_name, const char* type,
                                  uint64_t before, uint64_t behind) const {
    std::vector<uint64_t> shape = child_.header.shape;
    if (before > 0) shape.insert(shape.begin(), before);
    if (behind > 0) shape.push_back(behind);
    if (array.header.type != type || array.header.shape != shape)
        throw InputError(name_, array_name,
                         fmt::format("is not of type {} and shape ({})", type, fmt::join(shape, ", ")), kFix);
}

std::string PlenoctreeFile::place(const char* array, uint64_t cell) {
    return fmt::format("{}[{}, {}, {}, {}]", array, cell / 8, cell >> 2 & 1, cell >> 1 & 1, cell & 1);
}

float PlenoctreeFile::sigma(uint64_t cell) const {
    assert(row_ > 0);
    const uint64_t at = cell * row_ + row_ - 1;
    const float sigma = quantised_ ? float_from_half(sigma_.at<uint16_t>(cell))
                        : halves_  ? float_from_half(data_.at<uint16_t>(at))
                                   : data_.at<float>(at);
    if (std::isnan(sigma))
        throw InputError(name_, place(quantised_ ? "sigma" : "data", cell), "its density is not a number",
                         kExtractAnew);
    return sigma;
}

float PlenoctreeFile::quantised_number(uint64_t cell, uint64_t channel, uint64_t i) const {
    const uint64_t cells = 8 * nodes();
    if (i < retained_count_) return float_from_half(retained_.at<uint16_t>(3 * (i * cells + cell) + channel));
    const uint64_t palette = i - retained_count_, colours = palettes_.side(1);
    const uint64_t index = indices_.at<uint16_t>(palette * cells + cell);
    if (index >= colours)
        throw InputError(name_, place("quant_map", cell),
                         fmt::format("colour {} does not exist ({} do)", index, colours), kExtractAnew);
    return float_from_half(palettes_.at<uint16_t>(3 * (palette * colours + index) + channel));
}

void PlenoctreeFile::colours(uint64_t cell, float* to) const {
    assert(row_ > 0);
    const uint64_t count = row_ - 1, first = cell * row_, of_channel = format_.numbers;
    if (quantised_)
        for (uint64_t i = 0; i < count; ++i) to[i] = quantised_number(cell, i / of_channel, i % of_channel);
    else if (halves_)
        for (uint64_t i = 0; i < count; ++i) to[i] = float_from_half(data_.at<uint16_t>(first + i));
    else
        for (uint64_t i = 0; i < count; ++i) to[i] = data_.at<float>(first + i);
    for (uint64_t i = 0; i < count; ++i)
        if (!(std::abs(to[i]) <= kMostCoefficient))
            throw InputError(name_, place(quantised_ ? "quant_map" : "data", cell),
                             fmt::format("number {} is {}, no coefficient of a colour", i, to[i]), kExtractAnew);
}

PlenoctreeBox read_box_of_file(const std::filesystem::path& path) {
    return read_box(open_npz(path), path.string());
}

}  // namespace neuvv::voctree

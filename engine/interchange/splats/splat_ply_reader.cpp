#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>

#include "base/error.h"
#include "base/platform.h"
#include "base/sigmoid.h"
#include "interchange/splats/splat_ply.h"

namespace neuvv::interchange {

namespace {

constexpr size_t kMostHeader = 65536;  // bytes
constexpr float kLeastDeviation_m = 1e-7f, kMostLength_m = 1e6f, kMostColour = 1e6f;

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };
constexpr std::array<size_t, 8> kBytesOfType = {1, 1, 2, 2, 4, 4, 4, 8};

NumberType number_type(const std::string& name) {
    static const std::map<std::string, NumberType> kTypes = {
        {"char", NumberType::kInt8},      {"int8", NumberType::kInt8},     {"uchar", NumberType::kUint8},
        {"uint8", NumberType::kUint8},    {"short", NumberType::kInt16},   {"int16", NumberType::kInt16},
        {"ushort", NumberType::kUint16},  {"uint16", NumberType::kUint16}, {"int", NumberType::kInt32},
        {"int32", NumberType::kInt32},    {"uint", NumberType::kUint32},   {"uint32", NumberType::kUint32},
        {"float", NumberType::kFloat},    {"float32", NumberType::kFloat}, {"double", NumberType::kDouble},
        {"float64", NumberType::kDouble},
    };
    const auto found = kTypes.find(name);
    if (found == kTypes.end()) throw std::runtime_error("has a property of the type " + name);
    return found->second;
}

template <typename T>
float number_at(const uint8_t* at) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    return static_cast<float>(value);
}

struct Property {
    NumberType type;
    size_t offset;  // in a row
    float of(const uint8_t* row) const {
        const uint8_t* at = row + offset;
        switch (type) {
            case NumberType::kInt8:
                return number_at<int8_t>(at);
            case NumberType::kUint8:
                return number_at<uint8_t>(at);
            case NumberType::kInt16:
                return number_at<int16_t>(at);
            case NumberType::kUint16:
                return number_at<uint16_t>(at);
            case NumberType::kInt32:
                return number_at<int32_t>(at);
            case NumberType::kUint32:
                return number_at<uint32_t>(at);
            case NumberType::kFloat:
                return number_at<float>(at);
            case NumberType::kDouble:
                break;
        }
        double value = 0;
        std::memcpy(&value, at, sizeof(value));
        constexpr double kMost = std::numeric_limits<float>::max(), kInfinite = std::numeric_limits<double>::infinity();
        return static_cast<float>(std::abs(value) <= kMost ? value : value * kInfinite);
    }
};

// The vertices of a file.
struct Table {
    const uint8_t* rows = nullptr;
    size_t count = 0, bytes_of_row = 0;
    std::map<std::string, Property> properties;

    const Property& property(const std::string& name) const {
        const auto found = properties.find(name);
        if (found == properties.end()) throw std::runtime_error("has vertices without " + name);
        return found->second;
    }
};

struct PlyElement {
    std::string name;
    size_t count = 0, bytes_of_row = 0;
    std::map<std::string, Property> properties;
    bool has_lists = false;
};

std::vector<PlyElement> parse_header(const std::string& header) {
    std::vector<PlyElement> elements;
    std::istringstream lines(header);
    std::string line, format;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "format") words >> format;
        if (word == "element") {
            PlyElement& element = elements.emplace_back();
            if (!(words >> element.name >> element.count)) throw std::runtime_error("has a damaged header: " + line);
        }
        if (word != "property") continue;
        std::string type, name;
        if (elements.empty() || !(words >> type >> name)) throw std::runtime_error("has a damaged header");
        PlyElement& element = elements.back();
        element.has_lists |= type == "list";
        if (type == "list") continue;
        const Property property{number_type(type), element.bytes_of_row};
        element.properties.emplace(name, property);
        element.bytes_of_row += kBytesOfType[static_cast<size_t>(property.type)];
    }
    if (format != "binary_little_endian") throw std::runtime_error("is " + format + ", not binary_little_endian");
    return elements;
}

Table find_vertices(const std::vector<uint8_t>& bytes) {
    const std::string text(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(std::min(bytes.size(), kMostHeader)));
    if (!text.starts_with("ply")) throw std::runtime_error("is no .ply");
    const size_t end = text.find("\nend_header");
    const size_t begin = end == std::string::npos ? end : text.find('\n', end + 1);
    if (begin == std::string::npos) throw std::runtime_error("has no end of its header");
    size_t at = begin + 1;
    for (PlyElement& element : parse_header(text.substr(0, end))) {
        if (element.name == "chunk") throw std::runtime_error("is a compressed .ply");
        if (element.has_lists) throw std::runtime_error("has lists, as meshes have");
        if (element.bytes_of_row > 0 && element.count > (bytes.size() - at) / element.bytes_of_row)
            throw std::runtime_error(fmt::format("ends before its last {}", element.name));
        if (element.name == "vertex")
            return {bytes.data() + at, element.count, element.bytes_of_row, std::move(element.properties)};
        at += element.count * element.bytes_of_row;
    }
    throw std::runtime_error("has no vertices");
}

// The properties that make a splat.
class SplatColumns {
  public:
    explicit SplatColumns(const Table& table) {
        for (const char* name : {"x", "y", "z", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",
                                 "rot_3", "f_dc_0", "f_dc_1", "f_dc_2"})
            add(table, name);
        uint32_t rest = 0;
        while (rest < 3 * kMaxShCount && table.properties.contains(fmt::format("f_rest_{}", rest)))
            add(table, fmt::format("f_rest_{}", rest++));
        while (3 * (sh_count(degree) - 1) < rest && degree < kMaxHhDegree) ++degree;
        if (3 * (sh_count(degree) - 1) != rest)
            throw std::runtime_error(fmt::format("has {} harmonics, not those of a degree up to 3", rest / 3 + 1));
    }
    uint32_t degree = 0;

    // Nothing where it is left out; `why` then says so.
    std::optional<Splat> splat(const uint8_t* row, float scale, std::string& why) const {
        std::array<float, 14 + 3 * kMaxShCount> n{};
        for (size_t i = 0; i < columns_.size(); ++i) {
            n[i] = columns_[i].of(row);
            if (!std::isfinite(n[i]) && !may_be_infinite(i, n[i])) {
                why = fmt::format("whose {} is {}", names_[i], n[i]);
                return std::nullopt;
            }
        }
        Splat splat;
        splat.centre = scale * glm::vec3(n[0], n[1], n[2]);
        splat.opacity = sigmoid(n[3]);
        splat.deviation = scale * glm::exp(glm::vec3(n[4], n[5], n[6]));
        const glm::vec4 turn = glm::vec4(n[7], n[8], n[9], n[10]);
        const float length = glm::length(turn);
        why = excess_of(splat, n, columns_.size());
        if (!(length > 0) || !std::isfinite(length)) why = fmt::format("whose rotation has the length {}", length);
        if (!why.empty()) return std::nullopt;
        splat.deviation = glm::max(splat.deviation, kLeastDeviation_m);
        splat.rotation = glm::quat(turn[0] / length, turn[1] / length, turn[2] / length, turn[3] / length);
        const uint32_t count = sh_count(degree);
        for (uint32_t c = 0; c < 3; ++c) {
            splat.colour[0][static_cast<int>(c)] = n[kColour + c];
            for (uint32_t k = 1; k < count; ++k) splat.colour[k][static_cast<int>(c)] = n[14 + c * (count - 1) + k - 1];
        }
        return splat;
    }

  private:
    static constexpr size_t kOpacity = 3, kScale = 4, kRotation = 7, kColour = 11;

    void add(const Table& table, const std::string& name) {
        columns_.push_back(table.property(name));
        names_.push_back(name);
    }
    // The logits of 0 and 1, and the logarithm of 0.
    static bool may_be_infinite(size_t column, float value) {
        const bool is_scale = column >= kScale && column < kRotation;
        return !std::isnan(value) && (column == kOpacity || (is_scale && value < 0));
    }
    // What is larger than this program takes; empty where nothing is.
    std::string excess_of(const Splat& splat, std::span<const float> n, size_t columns) const {
        for (int i = 0; i < 3; ++i) {
            const auto at = static_cast<size_t>(i);
            if (!(std::abs(splat.centre[i]) <= kMostLength_m))
                return fmt::format("whose {} is {:.6g} m", names_[at], splat.centre[i]);
            if (!(splat.deviation[i] <= kMostLength_m))
                return fmt::format("whose {} is {:.6g}, a size of {:.3g} m", names_[kScale + at], n[kScale + at],
                                   splat.deviation[i]);
        }
        for (size_t i = kColour; i < columns; ++i)
            if (!(std::abs(n[i]) <= kMostColour)) return fmt::format("whose {} is {:.6g}", names_[i], n[i]);
        return "";
    }

    std::vector<Property> columns_;
    std::vector<std::string> names_;
};

PlySplats parse(const std::vector<uint8_t>& bytes, float scale) {
    const Table table = find_vertices(bytes);
    const SplatColumns columns(table);
    PlySplats read;
    read.splats.degree = columns.degree;
    if (table.count > available_memory_bytes() / 2 / sizeof(Splat))
        throw std::runtime_error(fmt::format("has {} splats, for which there is not enough memory", table.count));
    read.splats.splats.reserve(table.count);
    std::string why;
    for (size_t i = 0; i < table.count; ++i) {
        if (auto splat = columns.splat(table.rows + i * table.bytes_of_row, scale, why)) {
            splat->row = static_cast<uint32_t>(i);
            read.splats.splats.push_back(*splat);
        } else if (read.left_out++ == 0) {
            read.first_left_out = fmt::format("splat {}, {}", i, why);
        }
    }
    return read;
}

}  // namespace

PlySplats read_splat_ply(const std::filesystem::path& file, double scale) {
    const std::vector<uint8_t> bytes = read_file(file, available_memory_bytes() / 8);
    try {
        return parse(bytes, static_cast<float>(scale));
    } catch (const std::runtime_error& error) {
        throw InputError(file.string(), "", error.what(),
                         "write the binary .ply of 3D Gaussian Splatting, not compressed");
    }
}

}  // namespace neuvv::interchange

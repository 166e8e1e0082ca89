#include "interchange/volume/vdb_types.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "interchange/volume/vdb_reader.h"
#include "voctree/files/half.h"

namespace neuvv::interchange {

namespace {

constexpr VdbType kTypes[] = {
    {"float", VdbNumber::kFloat, 1, 4}, {"double", VdbNumber::kDouble, 1, 8}, {"half", VdbNumber::kHalf, 1, 2},
    {"int32", VdbNumber::kInt32, 1, 4}, {"int64", VdbNumber::kInt64, 1, 8},   {"bool", VdbNumber::kBool, 1, 1},
    {"mask", VdbNumber::kMask, 1, 1},   {"vec3s", VdbNumber::kFloat, 3, 4},   {"vec3d", VdbNumber::kDouble, 3, 8},
    {"vec3i", VdbNumber::kInt32, 3, 4},
};

float finite(double value) {
    constexpr double kMost = kMostVdbValue;
    return std::isnan(value) ? 0.0f : static_cast<float>(std::clamp(value, -kMost, kMost));
}

}  // namespace

const VdbType* find_vdb_type(const std::string& name) {
    const auto* found =
        std::find_if(std::begin(kTypes), std::end(kTypes), [&](const VdbType& type) { return type.name == name; });
    return found == std::end(kTypes) ? nullptr : found;
}

float read_vdb_number(stream::ByteReader& bytes, VdbNumber type) {
    switch (type) {
        case VdbNumber::kFloat:
            return finite(double{std::bit_cast<float>(static_cast<uint32_t>(bytes.number(4)))});
        case VdbNumber::kDouble:
            return finite(std::bit_cast<double>(bytes.number(8)));
        case VdbNumber::kHalf:
            return finite(double{voctree::float_from_half(static_cast<uint16_t>(bytes.number(2)))});
        case VdbNumber::kInt32:
            return static_cast<float>(static_cast<int32_t>(bytes.number(4)));
        case VdbNumber::kInt64:
            return static_cast<float>(static_cast<int64_t>(bytes.number(8)));
        case VdbNumber::kBool:
        case VdbNumber::kMask:
            break;
    }
    return bytes.number(1) != 0 ? 1.0f : 0.0f;
}

}  // namespace neuvv::interchange

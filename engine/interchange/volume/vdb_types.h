// The types of values in OpenVDB files.
#pragma once

#include <cstdint>
#include <string>

#include "stream/codec/bytes.h"

namespace neuvv::interchange {

enum class VdbNumber { kFloat, kDouble, kHalf, kInt32, kInt64, kBool, kMask };

struct VdbType {
    const char* name;
    VdbNumber number;
    uint32_t channels, bytes_of_number;
    bool is_real() const {
        return number == VdbNumber::kFloat || number == VdbNumber::kDouble || number == VdbNumber::kHalf;
    }
    // Leaves have bits in place of values.
    bool has_bits() const { return number == VdbNumber::kBool || number == VdbNumber::kMask; }
};

// Null for types that are not read.
const VdbType* find_vdb_type(const std::string& name);

// The next number, finite: what is none is 0, what is infinite is cut to ±kMostVdbValue (vdb_reader.h).
float read_vdb_number(stream::ByteReader& bytes, VdbNumber type);

}  // namespace neuvv::interchange

// Frames that were encoded for tests, and how two slices compare.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "stream/codec/frame_codec.h"

namespace neuvv::test {

inline stream::Steps steps(uint16_t step) {
    stream::Steps all;
    all.fill(step);
    return all;
}

struct Encoded {
    stream::Tables tables;
    std::vector<stream::FrameBytes> bytes;
    std::vector<stream::QuantisedSlice> decoded;  // by the encoder
};
inline Encoded encode(const std::vector<stream::QuantisedSlice>& slices, uint16_t step) {
    Encoded result;
    std::vector<stream::FrameSymbols> frames;
    stream::Counts counts = stream::no_counts();
    for (size_t i = 0; i < slices.size(); ++i) {
        stream::QuantisedSlice decoded;
        std::optional<stream::FrameBefore> before;
        if (i > 0) before.emplace(stream::FrameBefore{slices[i - 1], result.decoded.back()});
        frames.push_back(stream::encode(slices[i], steps(step), before, decoded));
        result.decoded.push_back(std::move(decoded));
        stream::count(frames.back(), counts);
    }
    result.tables = stream::tables_of(counts);
    for (const stream::FrameSymbols& frame : frames) result.bytes.push_back(stream::bytes_of(frame, result.tables));
    return result;
}

inline double error_of(const stream::QuantisedSlice& a, const stream::QuantisedSlice& b, uint32_t plane) {
    double sum = 0;
    for (size_t i = 0; i < a.leaves.size(); ++i) sum += std::abs(a.planes[plane][i] - b.planes[plane][i]);
    return sum / static_cast<double>(a.leaves.size());
}

inline void expect_same(const stream::QuantisedSlice& a, const stream::QuantisedSlice& b) {
    EXPECT_EQ(a.leaves, b.leaves);
    EXPECT_EQ(a.planes, b.planes);
}

}  // namespace neuvv::test

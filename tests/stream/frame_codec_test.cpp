// Frames as bytes and back.
#include "stream/codec/frame_decoder.h"

#include <gtest/gtest.h>

#include "stream/encoded_frames.h"
#include "stream/random_slice.h"

namespace neuvv::test::frame_codec_test {
namespace {

using stream::QuantisedSlice;

TEST(FrameCodec, DecodesWhatTheEncoderSays) {
    for (const uint32_t degree : {0u, 1u, 2u, 3u})
        for (const uint32_t depth : {2u, 6u, 8u}) {
            const QuantisedSlice slice = random_slice(7 * degree + depth, depth, 600, degree);
            double last = 0;
            for (const uint16_t step : {uint16_t{16}, uint16_t{60}, uint16_t{400}}) {
                const Encoded frame = encode({slice}, step);
                const stream::Format format{depth, degree, static_cast<uint32_t>(slice.leaves.size())};
                const QuantisedSlice decoded =
                    stream::decode(frame.bytes[0], stream::kShFine, frame.tables, format, nullptr);
                expect_same(decoded, frame.decoded[0]);
                EXPECT_EQ(decoded.leaves, slice.leaves);
                const double error = error_of(decoded, slice, 1);
                EXPECT_LT(error, 0.6 * step);
                EXPECT_GE(error, last);
                last = error;
            }
        }
}

// What a prefix shows is coarser, but it is the same place for place.
TEST(FrameCodec, EveryPrefixOfPartsDraws) {
    const QuantisedSlice slice = random_slice(3, 8, 900, 1);
    const Encoded frame = encode({slice}, 10);
    const stream::FrameBytes& bytes = frame.bytes[0];
    const stream::Format format{8, 1, 2000};
    double colour = 1e9, harmonics = 1e9;
    for (const stream::Part last :
         {stream::kShape, stream::kCoarse, stream::kShCoarse, stream::kFine, stream::kShFine}) {
        const QuantisedSlice decoded = stream::decode(bytes, last, frame.tables, format, nullptr);
        EXPECT_EQ(decoded.leaves, slice.leaves);
        const double of_colour = error_of(decoded, slice, 1), of_harmonics = error_of(decoded, slice, 7);
        EXPECT_LE(of_colour, colour);
        EXPECT_LE(of_harmonics, harmonics);
        colour = of_colour;
        harmonics = of_harmonics;
    }
    EXPECT_LT(colour, 10);
    EXPECT_LT(harmonics, 10);
}

TEST(FrameCodec, BlocksThatStayAreRepeated) {
    const QuantisedSlice first = random_slice(5, 6, 900, 1);
    QuantisedSlice moved = first;
    for (size_t i = 0; i < moved.leaves.size() / 10; ++i)
        for (auto& plane : moved.planes) plane[i] = static_cast<int16_t>(1000 - plane[i]);
    const Encoded frames = encode({first, first, moved}, 20);
    const auto size_of = [&](size_t frame) {
        size_t sum = 0;
        for (const auto& part : frames.bytes[frame].parts) sum += part.size();
        return sum;
    };
    EXPECT_LT(size_of(1), size_of(0) / 10);
    EXPECT_LT(size_of(2), size_of(0) / 3);
    EXPECT_GT(size_of(2), size_of(1));
    const stream::Format format{6, 1, 2000};
    std::vector<QuantisedSlice> decoded;
    for (size_t i = 0; i < 3; ++i) {
        decoded.push_back(stream::decode(frames.bytes[i], stream::kShFine, frames.tables, format,
                                         i == 0 ? nullptr : &decoded.back()));
        expect_same(decoded[i], frames.decoded[i]);
    }
    EXPECT_LT(error_of(decoded[2], moved, 1), 20);
    EXPECT_THROW(stream::decode(frames.bytes[1], stream::kShFine, frames.tables, format, nullptr), std::runtime_error);
}

// Whichever share of the frame before it repeats, it takes few more bytes than a key frame, or is one.
TEST(FrameCodec, AFrameThatGainsLittleByRepeatsIsAKeyFrame) {
    const QuantisedSlice first = random_slice(1, 6, 1500, 1);
    size_t keys = 0;
    for (const double share : {0.02, 0.1, 0.3, 0.6, 0.9}) {
        QuantisedSlice next = first;
        const auto begin = static_cast<size_t>(share * static_cast<double>(first.leaves.size()));
        for (auto& plane : next.planes)
            for (size_t i = begin; i < plane.size(); ++i) plane[i] = static_cast<int16_t>(1000 - plane[i]);
        const auto bytes_of = [&](const Encoded& frames) {
            size_t sum = 0;
            for (const auto& part : frames.bytes.back().parts) sum += part.size();
            return static_cast<double>(sum);
        };
        const Encoded after = encode({first, next}, 20), alone = encode({next}, 20);
        EXPECT_LT(bytes_of(after), 1.1 * bytes_of(alone)) << share;
        const bool is_key = after.bytes[1].parts[stream::kShape][0] == 1;
        keys += is_key ? 1 : 0;
        if (is_key)
            EXPECT_LT(share, 0.5);
        else
            EXPECT_LT(bytes_of(after), bytes_of(alone)) << share;
    }
    EXPECT_GT(keys, 0u);
    EXPECT_LT(keys, 5u);
}

TEST(FrameCodec, LeavesComeAndGo) {
    const QuantisedSlice empty = random_slice(1, 4, 0, 1);
    QuantisedSlice none = empty;
    none.leaves.clear();
    for (auto& plane : none.planes) plane.clear();
    const std::vector<QuantisedSlice> slices = {none, random_slice(2, 4, 60, 1), random_slice(3, 4, 60, 1), none};
    const Encoded frames = encode(slices, 20);
    const stream::Format format{4, 1, 400};
    QuantisedSlice before;
    for (size_t i = 0; i < slices.size(); ++i) {
        before = stream::decode(frames.bytes[i], stream::kShFine, frames.tables, format, i ? &before : nullptr);
        EXPECT_EQ(before.leaves, slices[i].leaves) << i;
    }
}

// The sanitizers see whether damage leads out of bounds.
TEST(FrameCodec, DamagedBytesAreRefusedOrShowSomethingElse) {
    const QuantisedSlice first = random_slice(5, 6, 300, 1), second = random_slice(6, 6, 300, 1);
    const Encoded frames = encode({first, second}, 30);
    const stream::Format format{6, 1, 2000};
    Random random(11);
    size_t refused = 0;
    for (int i = 0; i < 3000; ++i) {
        stream::FrameBytes damaged = frames.bytes[i % 2];
        std::vector<uint8_t>& bytes = damaged.parts[random.below(stream::kParts)];
        if (bytes.empty()) continue;
        for (uint32_t k = 0; k <= random.below(3); ++k)
            bytes[random.below(bytes.size())] = static_cast<uint8_t>(random.below(256));
        if (i % 7 == 0) bytes.resize(random.below(bytes.size()));
        try {
            const QuantisedSlice slice =
                stream::decode(damaged, stream::kShFine, frames.tables, format, i % 2 ? &frames.decoded[0] : nullptr);
            EXPECT_LE(slice.leaves.size(), 2000u);
            for (const auto& plane : slice.planes) ASSERT_EQ(plane.size(), slice.leaves.size());
        } catch (const std::runtime_error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 2000u);
}

}  // namespace
}  // namespace neuvv::test::frame_codec_test

// Frames as bytes and back.
#include "stream/codec/frame_decoder.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "stream/codec/group_decoder.h"
#include "stream/codec/group_slice.h"
#include "stream/random_slice.h"

namespace neuvv::test::frame_codec_test {
namespace {

using stream::QuantisedSlice;

stream::Steps steps(uint16_t step) {
    stream::Steps all;
    all.fill(step);
    return all;
}

struct Encoded {
    stream::Tables tables;
    std::vector<stream::FrameBytes> bytes;
    std::vector<QuantisedSlice> decoded;  // by the encoder
};
Encoded encode(const std::vector<QuantisedSlice>& slices, uint16_t step) {
    Encoded result;
    std::vector<stream::FrameSymbols> frames;
    stream::Counts counts = stream::no_counts();
    for (size_t i = 0; i < slices.size(); ++i) {
        QuantisedSlice decoded;
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

double error_of(const QuantisedSlice& a, const QuantisedSlice& b, uint32_t plane) {
    double sum = 0;
    for (size_t i = 0; i < a.leaves.size(); ++i) sum += std::abs(a.planes[plane][i] - b.planes[plane][i]);
    return sum / static_cast<double>(a.leaves.size());
}

void expect_same(const QuantisedSlice& a, const QuantisedSlice& b) {
    EXPECT_EQ(a.leaves, b.leaves);
    EXPECT_EQ(a.planes, b.planes);
}

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

// The C functions, which are given the parts of a frame one after the other.
struct OfGroup {
    explicit OfGroup(const Encoded& group, const stream::Format& format, uint32_t budget = 0) {
        const std::vector<uint8_t> tables = stream::bytes_of(group.tables);
        decoder.reset(
            neuvv_group_new(tables.data(), tables.size(), format.depth, format.degree, format.most_leaves, budget));
    }
    int32_t decode(const stream::FrameBytes& frame, uint32_t parts = stream::kParts,
                   decltype(neuvv_group_decode)* step = neuvv_group_decode) {
        std::vector<uint8_t> bytes;
        std::array<uint32_t, stream::kParts> sizes{};
        for (uint32_t part = 0; part < std::min<uint32_t>(parts, stream::kParts); ++part) {
            sizes[part] = static_cast<uint32_t>(frame.parts[part].size());
            bytes.insert(bytes.end(), frame.parts[part].begin(), frame.parts[part].end());
        }
        return step(decoder.get(), bytes.data(), bytes.size(), sizes.data(), parts);
    }
    void expect_last(const QuantisedSlice& slice) const {
        const NeuvvLeaf* leaves = neuvv_group_leaves(decoder.get());
        for (size_t i = 0; i < slice.leaves.size(); ++i) {
            EXPECT_EQ(leaves[i].cell, slice.leaves[i].cell);
            EXPECT_EQ(leaves[i].depth, slice.leaves[i].depth);
        }
        for (uint32_t plane = 0; plane < slice.planes.size(); ++plane) {
            const int16_t* numbers = neuvv_group_plane(decoder.get(), plane);
            EXPECT_EQ(std::vector<int16_t>(numbers, numbers + slice.leaves.size()), slice.planes[plane]);
        }
        EXPECT_FALSE(neuvv_group_plane(decoder.get(), static_cast<uint32_t>(slice.planes.size())));
    }
    std::string error() const { return neuvv_group_error(decoder.get()); }

    std::unique_ptr<NeuvvGroupDecoder, decltype(&neuvv_group_free)> decoder{nullptr, neuvv_group_free};
};

TEST(GroupDecoder, DecodesAsTheFunctionsOfCppDo) {
    const QuantisedSlice first = random_slice(5, 6, 600, 1);
    QuantisedSlice second = first;
    for (size_t i = 0; i < second.leaves.size() / 4; ++i) second.planes[1][i] = static_cast<int16_t>(900 - i);
    const Encoded frames = encode({first, second}, 20);
    const stream::Format format{6, 1, 2000};
    OfGroup group(frames, format);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(group.decode(frames.bytes[i]), static_cast<int32_t>(frames.decoded[i].leaves.size()));
        group.expect_last(frames.decoded[i]);
        ASSERT_TRUE(stream::last_slice(group.decoder.get()));
        EXPECT_EQ(stream::last_slice(group.decoder.get())->planes, frames.decoded[i].planes);
        EXPECT_EQ(group.error(), "");
    }
    OfGroup coarse(frames, format);
    EXPECT_GT(coarse.decode(frames.bytes[0], 2), 0);
    coarse.expect_last(stream::decode(frames.bytes[0], stream::kCoarse, frames.tables, format, nullptr));
    EXPECT_EQ(coarse.decode(frames.bytes[1]), -1);
    EXPECT_EQ(coarse.error(), "needs as many parts as the frame before it");
    EXPECT_FALSE(neuvv_group_leaves(coarse.decoder.get())) << "nothing is left of a group after an error";
    EXPECT_EQ(coarse.decode(frames.bytes[1]), -1);
    EXPECT_EQ(coarse.error(), "needs the frame before it");
    EXPECT_GT(coarse.decode(frames.bytes[0]), 0) << "but a key frame goes on";
    EXPECT_EQ(coarse.error(), "");
}

TEST(GroupDecoder, DecodesInTwoSteps) {
    const QuantisedSlice first = random_slice(5, 6, 600, 1);
    QuantisedSlice second = first;
    for (size_t i = 0; i < second.leaves.size() / 4; ++i) second.planes[1][i] = static_cast<int16_t>(900 - i);
    const Encoded frames = encode({first, second}, 20);
    OfGroup group(frames, {6, 1, 2000});
    EXPECT_EQ(group.decode(frames.bytes[0], stream::kParts, neuvv_group_decode_planes), -1);
    EXPECT_EQ(group.error(), "has no shape yet");
    for (size_t i = 0; i < 2; ++i) {
        const auto leaves = static_cast<int32_t>(frames.decoded[i].leaves.size());
        EXPECT_EQ(group.decode(frames.bytes[i], stream::kParts, neuvv_group_decode_shape), leaves);
        EXPECT_EQ(group.decode(frames.bytes[i], stream::kParts, neuvv_group_decode_planes), leaves);
        group.expect_last(frames.decoded[i]);
    }
    EXPECT_GT(group.decode(frames.bytes[1], 2, neuvv_group_decode_shape), 0);
    EXPECT_EQ(group.decode(frames.bytes[1], 2, neuvv_group_decode_planes), -1);
    EXPECT_EQ(group.error(), "needs as many parts as the frame before it");
}

// The leaves of a frame that was decoded from coarse parts, joined in double precision: what a coarser leaf has to
// have.
struct Joined {
    stream::Leaf leaf;
    double area = 0, opacity = 0;        // in areas of the finest leaves; the mean
    double colour_weight = 0, luma = 0;  // Σ area · opacity; the mean of plane 1
};
std::vector<Joined> joined(const QuantisedSlice& slice, uint32_t levels) {
    std::vector<Joined> all;
    for (size_t i = 0; i < slice.leaves.size(); ++i) {
        const uint32_t depth = std::min(slice.leaves[i].depth, slice.depth - levels), shift = 3 * (slice.depth - depth);
        const stream::Leaf leaf{slice.leaves[i].cell >> shift << shift, depth};
        if (all.empty() || all.back().leaf != leaf) all.push_back({leaf});
        const double area = std::pow(4, slice.depth - slice.leaves[i].depth),
                     weight = area * std::max<int16_t>(slice.planes[0][i], stream::kLeastOpacity);
        all.back().area += area;
        all.back().opacity += area * slice.planes[0][i];
        all.back().colour_weight += weight;
        all.back().luma += weight * slice.planes[1][i];
    }
    for (Joined& one : all) {
        one.opacity /= one.area;
        one.luma /= one.colour_weight;
    }
    return all;
}

// Leaves that lie side by side up to where they fill the side, then behind each other.
double opacity_along(const Joined& one, uint32_t finest) {
    const double opacity = one.opacity / stream::kUnit, filled = one.area / std::pow(4, finest - one.leaf.depth);
    return stream::kUnit * (filled < 1 ? opacity * filled : 1 - std::pow(1 - opacity, filled));
}

TEST(GroupDecoder, DecodesFewerLeavesFromWhatLargerCellsHave) {
    const QuantisedSlice first = random_slice(5, 8, 900, 1);
    QuantisedSlice second = first;
    for (size_t i = 0; i < second.leaves.size() / 4; ++i) second.planes[1][i] = static_cast<int16_t>(900 - i);
    const Encoded frames = encode({first, second}, 20);
    const stream::Format format{8, 1, 2000};
    ASSERT_EQ(frames.bytes[1].parts[stream::kShape][0], 0) << "it has to repeat some leaves";
    for (const uint32_t levels : {1u, 2u}) {
        OfGroup group(frames, format, static_cast<uint32_t>(joined(first, levels).size()));
        std::optional<QuantisedSlice> whole;
        for (size_t i = 0; i < 2; ++i) {
            const int32_t leaves = group.decode(frames.bytes[i], 3);
            whole =
                stream::decode(frames.bytes[i], stream::kShCoarse, frames.tables, format, whole ? &*whole : nullptr);
            const QuantisedSlice& slice = *stream::last_slice(group.decoder.get());
            const std::vector<Joined> wanted = joined(*whole, levels);
            ASSERT_EQ(slice.leaves.size(), wanted.size());
            EXPECT_EQ(static_cast<size_t>(leaves), wanted.size());
            EXPECT_EQ(neuvv_group_coarser(group.decoder.get()), levels);
            EXPECT_LT(wanted.size(), whole->leaves.size());
            // Leaves that are joined by one level have had the same values; of two levels, these were rounded.
            const double most_opacity = levels == 1 ? 0.5 : 2, most_luma = levels == 1 ? 1e-9 : 1;
            for (size_t k = 0; k < wanted.size(); ++k) {
                ASSERT_EQ(slice.leaves[k], wanted[k].leaf);
                EXPECT_NEAR(slice.planes[0][k], opacity_along(wanted[k], slice.depth), most_opacity);
                EXPECT_NEAR(slice.planes[1][k], wanted[k].luma, most_luma);
            }
        }
    }
}

TEST(GroupDecoder, KeepsToABudgetWhereItCan) {
    for (const uint32_t depth : {2u, 8u}) {
        const QuantisedSlice slice = random_slice(5, depth, 900, 1);
        const Encoded frames = encode({slice}, 20);
        const auto leaves = [&](uint32_t budget) {
            OfGroup group(frames, {depth, 1, 2000}, budget);
            return static_cast<uint32_t>(group.decode(frames.bytes[0]));
        };
        const auto all = static_cast<uint32_t>(slice.leaves.size());
        const auto least = static_cast<uint32_t>(joined(slice, std::min(2u, depth - 1)).size());
        EXPECT_EQ(leaves(0), all);
        EXPECT_EQ(leaves(all), all);
        EXPECT_LT(leaves(all - 1), all);
        EXPECT_EQ(leaves(least), least);
        EXPECT_EQ(leaves(1), least) << "fewer than there can be";
    }
}

TEST(GroupDecoder, RefusesWhatCannotBe) {
    const Encoded frames = encode({random_slice(5, 6, 100, 1)}, 20);
    for (const stream::Format& format :
         {stream::Format{7, 1, 2000}, {14, 1, 2000}, {0, 1, 2000}, {6, 4, 2000}, {6, 1, UINT32_MAX}})
        EXPECT_FALSE(OfGroup(frames, format).decoder);
    Encoded damaged = frames;
    damaged.tables.pop_back();
    EXPECT_FALSE(OfGroup(damaged, {6, 1, 2000}).decoder);
    OfGroup none(damaged, {6, 1, 2000});
    EXPECT_EQ(none.decode(frames.bytes[0]), -1);
    EXPECT_FALSE(neuvv_group_leaves(nullptr));
    EXPECT_FALSE(stream::last_slice(nullptr));
    EXPECT_FALSE(neuvv_group_plane(nullptr, 0));
    OfGroup group(frames, {6, 1, 2000});
    for (const uint32_t parts : {0u, 6u}) EXPECT_EQ(group.decode(frames.bytes[0], parts), -1);
    const std::array<uint32_t, stream::kParts> long_parts{1000, 1, 1, 1, 1};
    const std::vector<uint8_t> bytes(10);
    EXPECT_EQ(neuvv_group_decode(group.decoder.get(), bytes.data(), bytes.size(), long_parts.data(), 1), -1);
    EXPECT_EQ(group.error(), "ends early");
    OfGroup small(frames, {6, 1, 10});
    EXPECT_EQ(small.decode(frames.bytes[0]), -1);
    EXPECT_EQ(small.error(), "has more leaves than the stream says");
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
    size_t shown = 0;
    for (int i = 0; i < 3000; ++i) {
        OfGroup group(frames, format, i % 2 ? 299 : 1);
        group.decode(frames.bytes[0], 3);
        stream::FrameBytes damaged = frames.bytes[i / 2 % 2];
        std::vector<uint8_t>& bytes = damaged.parts[random.below(stream::kFine)];
        if (!bytes.empty()) bytes[random.below(bytes.size())] = static_cast<uint8_t>(random.below(256));
        if (group.decode(damaged, 3) > 0) ++shown;
    }
    EXPECT_LT(shown, 3000u);
}

}  // namespace
}  // namespace neuvv::test::frame_codec_test

// The decoder's C functions: frames in two steps, of fewer leaves, and from the beginnings of streams.
#include "stream/codec/group_decoder.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>

#include "stream/codec/frame_decoder.h"
#include "stream/codec/group_slice.h"
#include "stream/encoded_frames.h"
#include "stream/random_slice.h"

namespace neuvv::test::group_decoder_test {
namespace {

using stream::QuantisedSlice;

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

// The coarse part with so much of each stream, in per cent.
stream::FrameBytes with_beginnings(stream::FrameBytes frame, size_t percent) {
    std::vector<uint8_t>& part = frame.parts[stream::kCoarse];
    std::vector<uint8_t> lengths(4 * stream::kPlanesOfMean), streams;
    for (size_t plane = 0, at = lengths.size(); plane < stream::kPlanesOfMean; ++plane) {
        uint32_t length;
        std::memcpy(&length, &part[4 * plane], 4);
        const auto kept = static_cast<uint32_t>(length * percent / 200 * 2);  // whole words
        std::memcpy(&lengths[4 * plane], &kept, 4);
        streams.insert(streams.end(), part.begin() + static_cast<ptrdiff_t>(at),
                       part.begin() + static_cast<ptrdiff_t>(at + kept));
        at += length;
    }
    part = std::move(lengths);
    part.insert(part.end(), streams.begin(), streams.end());
    return frame;
}

TEST(GroupDecoder, BeginningsOfStreamsShowLessAndLess) {
    const QuantisedSlice slice = random_slice(5, 8, 900, 1);
    QuantisedSlice next = slice;
    next.planes[1][0] = 900;
    const Encoded frames = encode({slice, next}, 8);
    ASSERT_EQ(frames.bytes[1].parts[stream::kShape][0], 0) << "it has to repeat some leaves";
    const QuantisedSlice coarse =
        stream::decode(frames.bytes[0], stream::kCoarse, frames.tables, {8, 1, 2000}, nullptr);
    OfGroup group(frames, {8, 1, 2000});
    const auto decode = [&](const stream::FrameBytes& frame) {
        return group.decode(frame, 2, neuvv_group_decode_shape) < 0
                   ? -1
                   : group.decode(frame, 2, [](auto* decoder, auto* bytes, size_t count, auto* sizes, uint32_t) {
                         return neuvv_group_decode_beginnings(decoder, bytes, count, sizes);
                     });
    };
    double last = -1;
    for (const size_t percent : {100u, 80u, 50u, 20u, 0u}) {
        ASSERT_EQ(decode(with_beginnings(frames.bytes[0], percent)), static_cast<int32_t>(slice.leaves.size()));
        const QuantisedSlice& shown = *stream::last_slice(group.decoder.get());
        double error = 0;
        for (uint32_t plane = 0; plane < stream::kPlanesOfMean; ++plane) error += error_of(shown, coarse, plane);
        EXPECT_GT(error, last) << percent;
        if (percent == 100) expect_same(shown, coarse);
        last = error;
    }
    EXPECT_EQ(group.decode(frames.bytes[1], 2), -1) << "nothing repeats what is only begun";
    EXPECT_EQ(decode(frames.bytes[1]), -1);
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        stream::FrameBytes damaged = with_beginnings(frames.bytes[0], random.below(100));
        std::vector<uint8_t>& bytes = damaged.parts[stream::kCoarse];
        bytes[random.below(bytes.size())] = static_cast<uint8_t>(random.below(256));
        EXPECT_LE(decode(damaged), static_cast<int32_t>(slice.leaves.size()));
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

TEST(GroupDecoder, DamagedBytesWithABudgetAreRefusedOrShowSomethingElse) {
    const QuantisedSlice first = random_slice(5, 6, 300, 1), second = random_slice(6, 6, 300, 1);
    const Encoded frames = encode({first, second}, 30);
    Random random(12);
    size_t shown = 0;
    for (int i = 0; i < 3000; ++i) {
        OfGroup group(frames, {6, 1, 2000}, i % 2 ? 299 : 1);
        group.decode(frames.bytes[0], 3);
        stream::FrameBytes damaged = frames.bytes[i / 2 % 2];
        std::vector<uint8_t>& bytes = damaged.parts[random.below(stream::kFine)];
        if (!bytes.empty()) bytes[random.below(bytes.size())] = static_cast<uint8_t>(random.below(256));
        if (group.decode(damaged, 3) > 0) ++shown;
    }
    EXPECT_LT(shown, 3000u);
}

}  // namespace
}  // namespace neuvv::test::group_decoder_test

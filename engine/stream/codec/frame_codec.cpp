#include "stream/codec/frame_codec.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "stream/codec/bytes.h"
#include "stream/codec/repeats.h"
#include "stream/codec/shape.h"

namespace neuvv::stream {

std::vector<int32_t> colour_factors_of(const std::vector<int16_t>& opacity) {
    std::vector<int32_t> factors(opacity.size());
    for (size_t i = 0; i < factors.size(); ++i) factors[i] = std::max(opacity[i], kLeastOpacity);
    return factors;
}

namespace {

// From which fraction of a step on a coefficient is rounded up. Small ones cost more than they show.
constexpr double kRoundUp = 0.6, kRoundUpSh = 0.67;
constexpr int kMaxNumber = 32000;
// A frame that repeats this share of its leaves takes fewer bytes than a key frame, without a look.
constexpr double kMostlyRepeated = 0.75;

// Coefficients as numbers of steps.
std::vector<std::array<int16_t, kPairs>> numbers_of(const Coefficients& coefficients, double step, Kind kind) {
    const double up = kind >= kShLuma ? kRoundUpSh : kRoundUp;
    std::vector<std::array<int16_t, kPairs>> numbers(coefficients.values.size());
    for (size_t cell = 0; cell < numbers.size(); ++cell)
        for (size_t n = 1; n < kPairs; ++n) {
            const double value = coefficients.values[cell][n];
            const double number = std::floor(std::min(std::abs(value) / step + 1 - up, double{kMaxNumber}));
            numbers[cell][n] = static_cast<int16_t>(value < 0 ? -number : number);
        }
    return numbers;
}

// Encodes some planes, from `first` on, and sets those of `decoded` to what will be decoded.
void encode_planes(const QuantisedSlice& slice, const Octree& tree, const Pairs& pairs,
                   std::span<const int32_t> factors, uint32_t first, uint32_t count, FrameSymbols& frame,
                   QuantisedSlice& decoded, const InParts& in_parts) {
    in_parts(count, 3, [&](size_t begin, size_t end) {
        std::vector<std::vector<std::array<int16_t, kPairs>>> numbers;
        std::vector<PlaneOfTree> planes;
        for (uint32_t plane = first + static_cast<uint32_t>(begin); plane < first + end; ++plane) {
            const Kind kind = kind_of(plane);
            const Coefficients coefficients = transform(tree, pairs, factors, slice.planes[plane]);
            numbers.push_back(numbers_of(coefficients, frame.steps[kind], kind));
            frame.roots[plane] = rounded_value(static_cast<float>(coefficients.root), plane);
            decoded.planes[plane].resize(tree.leaf_count);
            planes.push_back({plane, static_cast<float>(frame.roots[plane]), static_cast<float>(frame.steps[kind]),
                              numbers.back(), decoded.planes[plane]});
        }
        code_planes(std::span(frame.coarse).subspan(first + begin, end - begin),
                    std::span(frame.fine).subspan(first + begin, end - begin), tree, pairs, slice.depth, planes);
    });
}

// The planes of a slice without repeated blocks. Colours need the decoded opacity.
void encode_all_planes(const QuantisedSlice& slice, const Octree& tree, FrameSymbols& frame, QuantisedSlice& decoded,
                       const InParts& in_parts) {
    const auto planes = static_cast<uint32_t>(slice.planes.size());
    decoded.planes.resize(planes);
    encode_planes(slice, tree, Pairs(tree), {}, kOpacityPlane, 1, frame, decoded, in_parts);
    const std::vector<int32_t> factors = colour_factors_of(decoded.planes[kOpacityPlane]);
    encode_planes(slice, tree, Pairs(tree, factors, 1.0 / kUnit), factors, kFirstColourPlane, planes - 1, frame,
                  decoded, in_parts);
}

// Whether the leaves of a block, from `a` on, are those of the other slice from `b` on.
bool is_same(const QuantisedSlice& slice, size_t a, const QuantisedSlice& before, size_t b, size_t count) {
    const auto same = [&](const auto& one, const auto& other) {
        return std::equal(one.begin() + static_cast<ptrdiff_t>(a), one.begin() + static_cast<ptrdiff_t>(a + count),
                          other.begin() + static_cast<ptrdiff_t>(b));
    };
    if (!same(slice.leaves, before.leaves)) return false;
    for (size_t plane = 0; plane < slice.planes.size(); ++plane)
        if (!same(slice.planes[plane], before.planes[plane])) return false;
    return true;
}

// Whether the leaves are in the same places and their planes differ by no more than rounding them does: by as much as
// coefficients of half a step.
bool is_similar(const QuantisedSlice& slice, size_t a, const QuantisedSlice& before, size_t b, size_t count,
                const Steps& steps) {
    std::vector<double> weights(count);
    for (size_t i = 0; i < count; ++i) {
        if (slice.leaves[a + i] != before.leaves[b + i]) return false;
        weights[i] = std::exp2(2 * (slice.depth - slice.leaves[a + i].depth));
    }
    for (uint32_t plane = 0; plane < slice.planes.size(); ++plane) {
        double squares = 0;
        for (size_t i = 0; i < count; ++i) {
            const double apart = slice.planes[plane][a + i] - before.planes[plane][b + i];
            squares += weights[i] * apart * apart;
        }
        const double step = steps[kind_of(plane)];
        if (squares > 0.25 * step * step * static_cast<double>(count)) return false;
        if (plane == kOpacityPlane)
            for (size_t i = 0; i < count; ++i)
                weights[i] *= std::max(before.planes[kOpacityPlane][b + i], kLeastOpacity) / double{kUnit};
    }
    return true;
}

void append_leaves(const QuantisedSlice& from, size_t begin, size_t end, QuantisedSlice& to) {
    const auto append = [&](const auto& numbers, auto& all) {
        all.insert(all.end(), numbers.begin() + static_cast<ptrdiff_t>(begin),
                   numbers.begin() + static_cast<ptrdiff_t>(end));
    };
    append(from.leaves, to.leaves);
    for (size_t plane = 0; plane < from.planes.size(); ++plane) append(from.planes[plane], to.planes[plane]);
}

QuantisedSlice without_leaves(const QuantisedSlice& slice) {
    QuantisedSlice empty{slice.depth, slice.degree, {}, {}};
    empty.planes.resize(slice.planes.size());
    return empty;
}

// Divides a slice into blocks that the frame before has, too, of which `repeated` becomes the leaves' indices there,
// and the rest, which it returns.
QuantisedSlice encode_repeated(const QuantisedSlice& slice, const FrameBefore& frames, FrameSymbols& frame,
                               std::vector<uint32_t>& repeated) {
    const QuantisedSlice& before = frames.decoded;
    const std::vector<size_t> blocks = blocks_of(before.leaves), own = blocks_of(slice.leaves);
    std::vector<bool> repeats(blocks.size() - 1);
    std::vector<bool> is_taken(slice.leaves.size());
    for (size_t i = 0, at = 0; i + 1 < blocks.size(); ++i) {
        const uint64_t block = before.leaves[blocks[i]].cell >> kBlockBits;
        while (at + 1 < own.size() && slice.leaves[own[at]].cell >> kBlockBits < block) ++at;
        if (at + 1 == own.size()) break;
        const size_t count = blocks[i + 1] - blocks[i];
        if (own[at + 1] - own[at] != count) continue;
        if (!is_same(slice, own[at], frames.slice, blocks[i], count) &&
            !is_similar(slice, own[at], before, blocks[i], count, frame.steps))
            continue;
        repeats[i] = true;
        std::fill_n(is_taken.begin() + static_cast<ptrdiff_t>(own[at]), count, true);
    }
    repeated = leaves_in(before.leaves, code_repeats(frame.shape, before.leaves, &repeats));
    QuantisedSlice rest = without_leaves(slice);
    for (size_t i = 0; i < slice.leaves.size(); ++i)
        if (!is_taken[i]) append_leaves(slice, i, i + 1, rest);
    return rest;
}

FrameSymbols no_symbols(const Steps& steps, size_t planes) {
    FrameSymbols frame;
    frame.steps = steps;
    frame.roots.resize(planes);
    frame.coarse.resize(planes);
    frame.fine.resize(planes);
    return frame;
}

// Encodes leaves that are not repeated, and returns them as they are decoded, with planes alone.
QuantisedSlice encode_leaves(const QuantisedSlice& leaves, FrameSymbols& frame, const InParts& in_parts) {
    frame.leaf_count = static_cast<uint32_t>(leaves.leaves.size());
    QuantisedSlice decoded = without_leaves(leaves);
    if (frame.leaf_count == 0) return decoded;
    const Octree tree = octree_of(leaves.leaves, leaves.depth);
    code_shape(frame.shape, tree, leaves.depth, frame.leaf_count);
    encode_all_planes(leaves, tree, frame, decoded, in_parts);
    return decoded;
}

FrameSymbols encode_key(const QuantisedSlice& slice, const Steps& steps, QuantisedSlice& decoded,
                        const InParts& in_parts) {
    FrameSymbols frame = no_symbols(steps, slice.planes.size());
    decoded = encode_leaves(slice, frame, in_parts);
    decoded.leaves = slice.leaves;
    return frame;
}

// `repeated_share`: of the leaves.
FrameSymbols encode_repeats(const QuantisedSlice& slice, const Steps& steps, const FrameBefore& before,
                            QuantisedSlice& decoded, double& repeated_share, const InParts& in_parts) {
    FrameSymbols frame = no_symbols(steps, slice.planes.size());
    frame.is_key = false;
    std::vector<uint32_t> repeated;
    const QuantisedSlice rest = encode_repeated(slice, before, frame, repeated);
    repeated_share =
        static_cast<double>(repeated.size()) / static_cast<double>(std::max<size_t>(slice.leaves.size(), 1));
    decoded = encode_leaves(rest, frame, in_parts);
    MergedLeaves merged = merge_leaves(before.decoded.leaves, repeated, rest.leaves, slice.depth);
    decoded.planes = merge_planes(merged, &before.decoded.planes, std::move(decoded.planes));
    decoded.leaves = std::move(merged.leaves);
    return frame;
}

// About how many bits a frame takes by the best tables of its own.
double bits_of(const FrameSymbols& frame) {
    Counts counts = no_counts();
    count(frame, counts);
    double bits = 0;
    for (const std::vector<uint32_t>& table : counts) {
        const auto all = static_cast<double>(std::accumulate(table.begin(), table.end(), uint64_t{0}));
        for (const uint32_t one : table)
            if (one > 0) bits += one * std::log2(all / one);
    }
    return bits;
}

}  // namespace

void in_one_part(size_t count, size_t /*grain*/, const std::function<void(size_t begin, size_t end)>& run) {
    if (count > 0) run(0, count);
}

FrameSymbols encode(const QuantisedSlice& slice, const Steps& steps, const std::optional<FrameBefore>& before,
                    QuantisedSlice& decoded, const InParts& in_parts) {
    if (!before) return encode_key(slice, steps, decoded, in_parts);
    QuantisedSlice decoded_repeats;
    double repeated_share = 0;
    FrameSymbols repeats = encode_repeats(slice, steps, *before, decoded_repeats, repeated_share, in_parts);
    if (repeated_share < kMostlyRepeated) {
        FrameSymbols key = encode_key(slice, steps, decoded, in_parts);
        if (bits_of(key) <= kKeyWorth * bits_of(repeats)) return key;
    }
    decoded = std::move(decoded_repeats);
    return repeats;
}

void count(const FrameSymbols& frame, Counts& counts) {
    frame.shape.count(counts);
    for (const auto* streams : {&frame.coarse, &frame.fine})
        for (const SymbolWriter& stream : *streams) stream.count(counts);
}

// A header and the shape; of the other parts the lengths of the streams, then these.
FrameBytes bytes_of(const FrameSymbols& frame, const Tables& tables) {
    FrameBytes result;
    std::vector<uint8_t>& header = result.parts[kShape];
    append_number(header, frame.is_key ? 1 : 0, 1);
    append_number(header, frame.leaf_count, 4);
    for (const uint16_t step : frame.steps) append_number(header, step, 2);
    for (const int16_t root : frame.roots) append_number(header, static_cast<uint16_t>(root), 2);
    const std::vector<uint8_t> shape = frame.shape.bytes(tables);
    append_number(header, shape.size(), 4);
    header.insert(header.end(), shape.begin(), shape.end());
    for (const Part part : {kCoarse, kShCoarse, kFine, kShFine}) {
        const auto [first, end] = planes_of_part(part, static_cast<uint32_t>(frame.roots.size()));
        const auto& streams = part == kCoarse || part == kShCoarse ? frame.coarse : frame.fine;
        std::vector<uint8_t> all;
        for (uint32_t plane = first; plane < end; ++plane) {
            const std::vector<uint8_t> one = streams[plane].bytes(tables);
            append_number(result.parts[part], one.size(), 4);
            all.insert(all.end(), one.begin(), one.end());
        }
        result.parts[part].insert(result.parts[part].end(), all.begin(), all.end());
    }
    return result;
}

}  // namespace neuvv::stream

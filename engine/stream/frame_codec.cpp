#include "stream/frame_codec.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "stream/bytes.h"
#include "stream/shape.h"

namespace neuvv::stream {

namespace {

// A leaf's colours matter by its opacity, but this at least.
constexpr int16_t kLeastOpacity = 20;
constexpr uint32_t kBlockBits = 6;  // of a cell's code: blocks of 4³ finest cells are repeated

// From which fraction of a step on a coefficient is rounded up. Small ones cost more than they show.
constexpr double kRoundUp = 0.6, kRoundUpSh = 0.67;
constexpr int kMaxNumber = 32000;

int16_t rounded_value(float value, uint32_t plane) {
    const float least = plane == kOpacityPlane ? 0 : -4 * kUnit, most = plane == kOpacityPlane ? kUnit : 4 * kUnit;
    const float raised = std::clamp(value, least, most) + 0.5f;
    const auto cut = static_cast<int32_t>(raised);  // std::floor is a call where the processor may be an old one
    return static_cast<int16_t>(static_cast<float>(cut) > raised ? cut - 1 : cut);
}

// What weighs a leaf's colours.
std::vector<double> weights_of(const std::vector<double>& areas, const std::vector<int16_t>& opacity) {
    std::vector<double> weights = areas;
    for (size_t i = 0; i < weights.size(); i++) weights[i] *= std::max(opacity[i], kLeastOpacity);
    return weights;
}

// Sets some planes of the slice, from `first` on, to what their numbers show.
void set_planes(const Octree& tree, const Pairs& pairs, const Numbers& numbers, const std::vector<int16_t>& roots,
                const Steps& steps, uint32_t first, Slice& slice) {
    std::vector<float> some_roots, some_steps;
    for (uint32_t plane = first; plane < first + numbers.planes; plane++) {
        some_roots.push_back(roots[plane]);
        some_steps.push_back(steps[kind_of(plane)]);
    }
    const std::vector<std::vector<float>> values = inverse_transform(tree, pairs, some_roots, some_steps, numbers);
    for (uint32_t p = 0; p < numbers.planes; p++) {
        std::vector<int16_t>& plane = slice.planes[first + p];
        plane.resize(values[p].size());
        for (size_t i = 0; i < plane.size(); i++) plane[i] = rounded_value(values[p][i], first + p);
    }
}

// Encodes some planes, from `first` on, and sets those of `decoded` to what will be decoded.
void encode_planes(const Slice& slice, const Octree& tree, const Pairs& pairs, const std::vector<double>& weights,
                   uint32_t first, uint32_t count, FrameSymbols& frame, Slice& decoded) {
    Numbers numbers{count, std::vector<int16_t>(count * pairs.size())};
    parallel_for(count, 1, [&](size_t begin, size_t end) {
        for (auto p = static_cast<uint32_t>(begin); p < end; p++) {
            const uint32_t plane = first + p;
            const Kind kind = kind_of(plane);
            const Coefficients coefficients = transform(tree, pairs, weights, slice.planes[plane]);
            const double step = frame.steps[kind], up = kind >= kShLuma ? kRoundUpSh : kRoundUp;
            PlaneNumbers own(numbers, p);
            for (size_t i = 0; i < pairs.size(); i++) {
                const double number = std::min(std::abs(coefficients.values[i]) / step + 1 - up, double{kMaxNumber});
                own[i] = static_cast<int16_t>(coefficients.values[i] < 0 ? -std::floor(number) : std::floor(number));
            }
            frame.roots[plane] = rounded_value(static_cast<float>(coefficients.root), plane);
            code_plane(frame.coarse[plane], &frame.fine[plane], tree, slice.depth, kind, own);
        }
    });
    set_planes(tree, pairs, numbers, frame.roots, frame.steps, first, decoded);
}

// The planes of a slice without repeated blocks. Colours need the decoded opacity.
void encode_all_planes(const Slice& slice, const Octree& tree, FrameSymbols& frame, Slice& decoded) {
    const std::vector<double> areas = areas_of(slice.leaves, slice.depth);
    const auto planes = static_cast<uint32_t>(slice.planes.size());
    decoded.planes.resize(planes);
    encode_planes(slice, tree, pairs_of(tree, areas, 1), areas, kOpacityPlane, 1, frame, decoded);
    const std::vector<double> weights = weights_of(areas, decoded.planes[kOpacityPlane]);
    encode_planes(slice, tree, pairs_of(tree, weights, 1.0 / kUnit), weights, kFirstColourPlane, planes - 1, frame,
                  decoded);
}

// The blocks of a slice: the index of the first leaf of each, and the end.
std::vector<size_t> blocks_of(const Slice& slice) {
    std::vector<size_t> first;
    for (size_t i = 0; i < slice.leaves.size(); i++)
        if (i == 0 || slice.leaves[i].cell >> kBlockBits != slice.leaves[i - 1].cell >> kBlockBits) first.push_back(i);
    first.push_back(slice.leaves.size());
    return first;
}

// Whether the leaves of a block, from `a` on, are those of the other slice from `b` on.
bool is_same(const Slice& slice, size_t a, const Slice& before, size_t b, size_t count) {
    const auto same = [&](const auto& one, const auto& other) {
        return std::equal(one.begin() + static_cast<ptrdiff_t>(a), one.begin() + static_cast<ptrdiff_t>(a + count),
                          other.begin() + static_cast<ptrdiff_t>(b));
    };
    if (!same(slice.leaves, before.leaves)) return false;
    for (size_t plane = 0; plane < slice.planes.size(); plane++)
        if (!same(slice.planes[plane], before.planes[plane])) return false;
    return true;
}

// Whether the leaves are in the same places and their planes differ by no more than rounding them does: by as much as
// coefficients of half a step.
bool is_similar(const Slice& slice, size_t a, const Slice& before, size_t b, size_t count, const Steps& steps) {
    std::vector<double> weights(count);
    for (size_t i = 0; i < count; i++) {
        if (slice.leaves[a + i] != before.leaves[b + i]) return false;
        weights[i] = std::exp2(2 * (slice.depth - slice.leaves[a + i].depth));
    }
    for (uint32_t plane = 0; plane < slice.planes.size(); plane++) {
        double squares = 0;
        for (size_t i = 0; i < count; i++) {
            const double apart = slice.planes[plane][a + i] - before.planes[plane][b + i];
            squares += weights[i] * apart * apart;
        }
        const double step = steps[kind_of(plane)];
        if (squares > 0.25 * step * step * static_cast<double>(count)) return false;
        if (plane == kOpacityPlane)
            for (size_t i = 0; i < count; i++)
                weights[i] *= std::max(before.planes[kOpacityPlane][b + i], kLeastOpacity) / double{kUnit};
    }
    return true;
}

void append_leaf(const Slice& from, size_t leaf, Slice& to) {
    to.leaves.push_back(from.leaves[leaf]);
    for (size_t plane = 0; plane < from.planes.size(); plane++) to.planes[plane].push_back(from.planes[plane][leaf]);
}

Slice without_leaves(const Slice& slice) {
    Slice empty{slice.depth, slice.degree, {}, {}};
    empty.planes.resize(slice.planes.size());
    return empty;
}

// Codes which blocks of the frame before are repeated, and returns their leaves.
template <typename Coder>
Slice code_repeated(Coder& coder, const Slice& before, const std::vector<bool>* repeats) {
    Slice repeated = without_leaves(before);
    const std::vector<size_t> blocks = blocks_of(before);
    uint32_t last = 0;
    for (size_t i = 0; i + 1 < blocks.size(); i++) {
        last = coder.take(kRepeatTables + last, repeats && (*repeats)[i] ? 1 : 0);
        for (size_t leaf = blocks[i]; last && leaf < blocks[i + 1]; leaf++) append_leaf(before, leaf, repeated);
    }
    return repeated;
}

// The leaves of both, in order of their cells. Throws std::runtime_error where they overlap.
Slice merged(const Slice& a, const Slice& b) {
    if (a.leaves.empty()) return b;
    Slice both = without_leaves(a);
    size_t next = 0;
    for (size_t i = 0; i < a.leaves.size(); i++) {
        for (; next < b.leaves.size() && b.leaves[next].cell < a.leaves[i].cell; next++) append_leaf(b, next, both);
        append_leaf(a, i, both);
    }
    for (; next < b.leaves.size(); next++) append_leaf(b, next, both);
    for (size_t i = 0; i + 1 < both.leaves.size(); i++) {
        const uint64_t cells = uint64_t{1} << 3 * (both.depth - both.leaves[i].depth);
        if (both.leaves[i + 1].cell - both.leaves[i].cell < cells)
            throw std::runtime_error("repeats leaves where it has others");
    }
    return both;
}

// Divides a slice into blocks that the frame before has, too, and the rest.
Slice encode_repeated(const Slice& slice, const FrameBefore& frames, FrameSymbols& frame, Slice& repeated) {
    const Slice& before = frames.decoded;
    const std::vector<size_t> blocks = blocks_of(before), own = blocks_of(slice);
    std::vector<bool> repeats(blocks.size() - 1);
    std::vector<bool> is_taken(slice.leaves.size());
    for (size_t i = 0, at = 0; i + 1 < blocks.size(); i++) {
        const uint64_t block = before.leaves[blocks[i]].cell >> kBlockBits;
        while (at + 1 < own.size() && slice.leaves[own[at]].cell >> kBlockBits < block) at++;
        if (at + 1 == own.size()) break;
        const size_t count = blocks[i + 1] - blocks[i];
        if (own[at + 1] - own[at] != count) continue;
        if (!is_same(slice, own[at], frames.slice, blocks[i], count) &&
            !is_similar(slice, own[at], before, blocks[i], count, frame.steps))
            continue;
        repeats[i] = true;
        std::fill_n(is_taken.begin() + static_cast<ptrdiff_t>(own[at]), count, true);
    }
    repeated = code_repeated(frame.shape, before, &repeats);
    Slice rest = without_leaves(slice);
    for (size_t i = 0; i < slice.leaves.size(); i++)
        if (!is_taken[i]) append_leaf(slice, i, rest);
    return rest;
}

}  // namespace

FrameSymbols encode(const Slice& slice, const Steps& steps, const std::optional<FrameBefore>& before, Slice& decoded) {
    FrameSymbols frame;
    frame.is_key = !before;
    frame.steps = steps;
    const size_t planes = slice.planes.size();
    frame.roots.resize(planes);
    frame.coarse.resize(planes);
    frame.fine.resize(planes);
    Slice repeated = without_leaves(slice);
    const Slice rest = before ? encode_repeated(slice, *before, frame, repeated) : slice;
    frame.leaf_count = static_cast<uint32_t>(rest.leaves.size());
    Slice coded = without_leaves(slice);
    coded.leaves = rest.leaves;
    if (frame.leaf_count > 0) {
        const Octree tree = octree_of(rest.leaves, rest.depth);
        code_shape(frame.shape, tree, rest.depth, frame.leaf_count);
        encode_all_planes(rest, tree, frame, coded);
    }
    decoded = merged(repeated, coded);
    return frame;
}

void count(const FrameSymbols& frame, Counts& counts) {
    frame.shape.count(counts);
    for (const auto* streams : {&frame.coarse, &frame.fine})
        for (const SymbolWriter& stream : *streams) stream.count(counts);
}

namespace {

// The planes of a part.
std::pair<uint32_t, uint32_t> planes_of_part(Part part, uint32_t planes) {
    if (part == kCoarse || part == kFine) return {0, 4};
    return {4, planes};
}

// A plane of which the streams are not there has numbers of 0.
void read_plane(std::span<const uint8_t> coarse, std::span<const uint8_t> fine, const Tables& tables,
                const Octree& tree, const Format& format, Kind kind, PlaneNumbers numbers) {
    if (coarse.empty() && fine.empty()) return;
    SymbolReader in_coarse(coarse, tables), in_fine(fine, tables);
    code_plane(in_coarse, fine.empty() ? nullptr : &in_fine, tree, format.depth, kind, numbers);
    if (!in_coarse.ends_well() || !in_fine.ends_well()) throw std::runtime_error("has a damaged plane");
}

}  // namespace

// A head, the lengths of the streams of a part before them.
FrameBytes bytes_of(const FrameSymbols& frame, const Tables& tables) {
    FrameBytes result{};
    std::vector<uint8_t>& bytes = result.bytes;
    append_number(bytes, frame.is_key ? 1 : 0, 1);
    append_number(bytes, frame.leaf_count, 4);
    for (const uint16_t step : frame.steps) append_number(bytes, step, 2);
    for (const int16_t root : frame.roots) append_number(bytes, static_cast<uint16_t>(root), 2);
    const std::vector<uint8_t> shape = frame.shape.bytes(tables);
    append_number(bytes, shape.size(), 4);
    bytes.insert(bytes.end(), shape.begin(), shape.end());
    result.ends[kShape] = static_cast<uint32_t>(bytes.size());
    for (const Part part : {kCoarse, kFine, kShCoarse, kShFine}) {
        const auto [first, end] = planes_of_part(part, static_cast<uint32_t>(frame.roots.size()));
        const auto& streams = part == kCoarse || part == kShCoarse ? frame.coarse : frame.fine;
        std::vector<uint8_t> all;
        for (uint32_t plane = first; plane < end; plane++) {
            const std::vector<uint8_t> one = streams[plane].bytes(tables);
            append_number(bytes, one.size(), 4);
            all.insert(all.end(), one.begin(), one.end());
        }
        bytes.insert(bytes.end(), all.begin(), all.end());
        result.ends[part] = static_cast<uint32_t>(bytes.size());
    }
    return result;
}

Slice decode(std::span<const uint8_t> bytes, Part last, const Tables& tables, const Format& format,
             const Slice* before) {
    ByteReader reader(bytes);
    const uint64_t key = reader.number(1);
    if (key > 1) throw std::runtime_error("is no frame that this program knows");
    const bool is_key = key == 1;
    if (!is_key && !before) throw std::runtime_error("needs the frame before it");
    const auto leaf_count = static_cast<uint32_t>(reader.number(4));
    if (leaf_count > format.most_leaves) throw std::runtime_error("has more leaves than the stream says");
    Steps steps;
    for (uint16_t& step : steps) step = static_cast<uint16_t>(reader.number(2));
    const uint32_t planes = planes_of(format.degree);
    std::vector<int16_t> roots(planes);
    for (int16_t& root : roots) root = static_cast<int16_t>(reader.number(2));

    Slice coded{format.depth, format.degree, {}, {}};
    coded.planes.resize(planes);
    Slice repeated = coded;
    SymbolReader shape(reader.take(reader.number(4)), tables);
    if (!is_key) repeated = code_repeated(shape, *before, nullptr);
    if (repeated.leaves.size() + leaf_count > format.most_leaves)
        throw std::runtime_error("has more leaves than the stream says");
    const Octree tree = leaf_count > 0 ? code_shape(shape, Octree(), format.depth, leaf_count) : Octree();
    if (!shape.ends_well() || tree.leaf_count != leaf_count) throw std::runtime_error("has another shape than it says");

    std::vector<std::span<const uint8_t>> coarse(planes), fine(planes);
    for (const Part part : {kCoarse, kFine, kShCoarse, kShFine}) {
        if (part > last) break;
        const auto [first, end] = planes_of_part(part, planes);
        std::vector<uint64_t> lengths;
        for (uint32_t plane = first; plane < end; plane++) lengths.push_back(reader.number(4));
        auto& streams = part == kCoarse || part == kShCoarse ? coarse : fine;
        for (uint32_t plane = first; plane < end; plane++) streams[plane] = reader.take(lengths[plane - first]);
        for (const uint64_t length : lengths)
            if (leaf_count == 0 && length > 0) throw std::runtime_error("has planes without leaves");
    }
    reader.expect_end();
    if (leaf_count == 0) return repeated;
    coded.leaves = leaves_of(tree, format.depth);

    const auto decode_planes = [&](const Pairs& pairs, uint32_t first, uint32_t count) {
        Numbers numbers{count, std::vector<int16_t>(count * pairs.size())};
        parallel_for(count, 1, [&](size_t begin, size_t end) {
            for (auto p = static_cast<uint32_t>(begin); p < end; p++)
                read_plane(coarse[first + p], fine[first + p], tables, tree, format, kind_of(first + p),
                           PlaneNumbers(numbers, p));
        });
        set_planes(tree, pairs, numbers, roots, steps, first, coded);
    };
    const std::vector<double> areas = areas_of(coded.leaves, format.depth);
    decode_planes(pairs_of(tree, areas, 1), kOpacityPlane, 1);
    const std::vector<double> weights = weights_of(areas, coded.planes[kOpacityPlane]);
    decode_planes(pairs_of(tree, weights, 1.0 / kUnit), kFirstColourPlane, planes - 1);
    return merged(repeated, coded);
}

}  // namespace neuvv::stream

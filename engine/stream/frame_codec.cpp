#include "stream/frame_codec.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>

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

// What weighs a leaf's colours.
std::vector<double> weights_of(const std::vector<double>& areas, const std::vector<int16_t>& opacity) {
    std::vector<double> weights = areas;
    for (size_t i = 0; i < weights.size(); i++) weights[i] *= std::max(opacity[i], kLeastOpacity);
    return weights;
}

// Encodes some planes, from `first` on, and sets those of `decoded` to what will be decoded.
void encode_planes(const Slice& slice, const Octree& tree, const Pairs& pairs, const std::vector<double>& weights,
                   uint32_t first, uint32_t count, FrameSymbols& frame, Slice& decoded) {
    std::vector<std::vector<int16_t>> numbers(count);
    std::vector<PlaneOfTree> planes(count);
    parallel_for(count, 1, [&](size_t begin, size_t end) {
        for (auto p = static_cast<uint32_t>(begin); p < end; p++) {
            const uint32_t plane = first + p;
            const Kind kind = kind_of(plane);
            const Coefficients coefficients = transform(tree, pairs, weights, slice.planes[plane]);
            const double step = frame.steps[kind], up = kind >= kShLuma ? kRoundUpSh : kRoundUp;
            for (const double value : coefficients.values) {
                const double number = std::floor(std::min(std::abs(value) / step + 1 - up, double{kMaxNumber}));
                numbers[p].push_back(static_cast<int16_t>(value < 0 ? -number : number));
            }
            frame.roots[plane] = rounded_value(static_cast<float>(coefficients.root), plane);
            decoded.planes[plane].resize(tree.leaf_count);
            planes[p] = {plane, static_cast<float>(frame.roots[plane]), static_cast<float>(frame.steps[kind]),
                         numbers[p], decoded.planes[plane]};
        }
    });
    code_planes(std::span(frame.coarse).subspan(first, count), std::span(frame.fine).subspan(first, count), tree, pairs,
                slice.depth, planes);
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

void append_leaves(const Slice& from, size_t begin, size_t end, Slice& to) {
    const auto append = [&](const auto& numbers, auto& all) {
        all.insert(all.end(), numbers.begin() + static_cast<ptrdiff_t>(begin),
                   numbers.begin() + static_cast<ptrdiff_t>(end));
    };
    append(from.leaves, to.leaves);
    for (size_t plane = 0; plane < from.planes.size(); plane++) append(from.planes[plane], to.planes[plane]);
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
        if (last) append_leaves(before, blocks[i], blocks[i + 1], repeated);
    }
    return repeated;
}

// The leaves of both, in order of their cells. Throws std::runtime_error where they overlap.
Slice merged(Slice a, Slice b) {
    if (a.leaves.empty()) return b;
    Slice both = without_leaves(a);
    // Runs of the one that come before the next leaf of the other.
    const auto append_run = [&](const Slice& from, size_t& at, uint64_t until) {
        const size_t begin = at;
        while (at < from.leaves.size() && from.leaves[at].cell < until) at++;
        append_leaves(from, begin, at, both);
    };
    // Of two leaves in the same cell, that of `a` comes last; what follows finds them.
    for (size_t i = 0, j = 0; i < a.leaves.size() || j < b.leaves.size();) {
        append_run(a, i, j < b.leaves.size() ? b.leaves[j].cell : UINT64_MAX);
        append_run(b, j, i < a.leaves.size() ? a.leaves[i].cell + 1 : UINT64_MAX);
    }
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
        if (!is_taken[i]) append_leaves(slice, i, i + 1, rest);
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
    if (part == kCoarse || part == kFine) return {0, kPlanesOfMean};
    return {kPlanesOfMean, planes};
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

namespace {

// A frame that is being decoded.
class FrameReader {
  public:
    FrameReader(std::span<const uint8_t> bytes, Part last, const Tables& tables, const Format& format)
        : bytes_(bytes),
          last_(last),
          tables_(tables),
          format_(format),
          planes_(planes_of(format.degree)),
          roots_(planes_),
          coarse_(planes_),
          fine_(planes_) {
        coded_.depth = format.depth;
        coded_.degree = format.degree;
        coded_.planes.resize(planes_);
    }

    Slice read(const Slice* before) {
        read_head(before != nullptr);
        Slice repeated = read_shape(before);
        for (const Part part : {kCoarse, kFine, kShCoarse, kShFine})
            if (part <= last_) find_streams(part);
        bytes_.expect_end();
        if (leaf_count_ == 0) return repeated;
        coded_.leaves = leaves_of(tree_, format_.depth);
        const std::vector<double> areas = areas_of(coded_.leaves, format_.depth);
        decode_planes(pairs_of(tree_, areas, 1), kOpacityPlane, 1);
        const std::vector<double> weights = weights_of(areas, coded_.planes[kOpacityPlane]);
        const Pairs pairs = pairs_of(tree_, weights, 1.0 / kUnit);
        decode_colours(pairs);
        return merged(std::move(repeated), std::move(coded_));
    }

  private:
    void read_head(bool has_before) {
        const uint64_t key = bytes_.number(1);
        if (key > 1) throw std::runtime_error("is no frame that this program knows");
        is_key_ = key == 1;
        if (!is_key_ && !has_before) throw std::runtime_error("needs the frame before it");
        leaf_count_ = static_cast<uint32_t>(bytes_.number(4));
        if (leaf_count_ > format_.most_leaves) throw std::runtime_error("has more leaves than the stream says");
        for (uint16_t& step : steps_) step = static_cast<uint16_t>(bytes_.number(2));
        for (int16_t& root : roots_) root = static_cast<int16_t>(bytes_.number(2));
    }

    // Reads which leaves there are, and returns those that are repeated.
    Slice read_shape(const Slice* before) {
        Slice repeated = without_leaves(coded_);
        SymbolReader shape(bytes_.take(bytes_.number(4)), tables_);
        if (!is_key_) repeated = code_repeated(shape, *before, nullptr);
        if (repeated.leaves.size() + leaf_count_ > format_.most_leaves)
            throw std::runtime_error("has more leaves than the stream says");
        if (leaf_count_ > 0) tree_ = code_shape(shape, Octree(), format_.depth, leaf_count_);
        if (!shape.ends_well() || tree_.leaf_count != leaf_count_)
            throw std::runtime_error("has another shape than it says");
        return repeated;
    }

    void find_streams(Part part) {
        const auto [first, end] = planes_of_part(part, planes_);
        std::vector<uint64_t> lengths;
        for (uint32_t plane = first; plane < end; plane++) lengths.push_back(bytes_.number(4));
        auto& streams = part == kCoarse || part == kShCoarse ? coarse_ : fine_;
        for (uint32_t plane = first; plane < end; plane++) streams[plane] = bytes_.take(lengths[plane - first]);
        for (const uint64_t length : lengths)
            if (leaf_count_ == 0 && length > 0) throw std::runtime_error("has planes without leaves");
    }

    // The planes of colours do not need each other. More than two cores decode three planes at a time each; of two, the
    // other one has trees to make.
    void decode_colours(const Pairs& pairs) {
        const uint32_t colours = planes_ - kFirstColourPlane;
        if (std::thread::hardware_concurrency() > 2)
            return parallel_for(colours, 3, [&](size_t begin, size_t end) {
                decode_planes(pairs, kFirstColourPlane + static_cast<uint32_t>(begin),
                              static_cast<uint32_t>(end - begin));
            });
        decode_planes(pairs, kFirstColourPlane, kPlanesOfMean - kFirstColourPlane);
        if (planes_ > kPlanesOfMean) decode_planes(pairs, kPlanesOfMean, planes_ - kPlanesOfMean);
    }

    // Decodes `count` planes from `first` on, which are all in the same parts.
    void decode_planes(const Pairs& pairs, uint32_t first, uint32_t count) {
        std::vector<PlaneOfTree> own;
        for (uint32_t plane = first; plane < first + count; plane++) {
            coded_.planes[plane].resize(leaf_count_);
            own.push_back({plane,
                           static_cast<float>(roots_[plane]),
                           static_cast<float>(steps_[kind_of(plane)]),
                           {},
                           coded_.planes[plane]});
        }
        const bool is_mean = first < kPlanesOfMean;
        const auto readers_of = [&](const auto& streams, Part part) {
            std::vector<SymbolReader> readers;
            for (uint32_t plane = first; part <= last_ && plane < first + count; plane++)
                readers.emplace_back(streams[plane], tables_);
            return readers;
        };
        std::vector<SymbolReader> coarse = readers_of(coarse_, is_mean ? kCoarse : kShCoarse);
        std::vector<SymbolReader> fine = readers_of(fine_, is_mean ? kFine : kShFine);
        code_planes<SymbolReader>(coarse, fine, tree_, pairs, format_.depth, own);
        for (const auto* readers : {&coarse, &fine})
            for (const SymbolReader& reader : *readers)
                if (!reader.ends_well()) throw std::runtime_error("has a damaged plane");
    }

    ByteReader bytes_;
    Part last_;
    const Tables& tables_;
    const Format& format_;
    uint32_t planes_;
    bool is_key_ = true;
    uint32_t leaf_count_ = 0;  // that are not repeated
    Steps steps_{};
    std::vector<int16_t> roots_;                           // by plane
    std::vector<std::span<const uint8_t>> coarse_, fine_;  // by plane; empty where the part is not there
    Octree tree_;
    Slice coded_;  // the leaves of the tree
};

}  // namespace

Slice decode(std::span<const uint8_t> bytes, Part last, const Tables& tables, const Format& format,
             const Slice* before) {
    return FrameReader(bytes, last, tables, format).read(before);
}

}  // namespace neuvv::stream

#include "stream/codec/frame_decoder.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stream/codec/bytes.h"
#include "stream/codec/shape.h"

namespace neuvv::stream {

FrameShape decode_shape(std::span<const uint8_t> bytes, const Tables& tables, const Format& format,
                        const std::vector<Leaf>* before) {
    FrameShape frame;
    ByteReader reader(bytes);
    const uint64_t key = reader.number(1);
    if (key > 1) throw std::runtime_error("is no frame that this program knows");
    if (key == 0 && !before) throw std::runtime_error("needs the frame before it");
    frame.is_key = key == 1;
    const uint64_t own_leaves = reader.number(4);
    if (own_leaves > format.most_leaves) throw std::runtime_error("has more leaves than the stream says");
    for (uint16_t& step : frame.steps) step = static_cast<uint16_t>(reader.number(2));
    frame.roots.resize(planes_of(format.degree));
    for (int16_t& root : frame.roots) root = static_cast<int16_t>(reader.number(2));
    SymbolReader symbols(reader.take(reader.number(4)), tables);
    reader.expect_end();
    static const std::vector<Leaf> kNoLeaves;
    const std::vector<Leaf>& leaves_before = frame.is_key ? kNoLeaves : *before;
    frame.repeats = code_repeats(symbols, leaves_before, nullptr);
    const std::vector<uint32_t> repeated = leaves_in(leaves_before, frame.repeats);
    if (repeated.size() + own_leaves > format.most_leaves)
        throw std::runtime_error("has more leaves than the stream says");
    if (own_leaves > 0) frame.tree = code_shape(symbols, Octree(), format.depth, static_cast<uint32_t>(own_leaves));
    if (!symbols.ends_well() || frame.tree.leaf_count != own_leaves)
        throw std::runtime_error("has another shape than it says");
    frame.merged = merge_leaves(leaves_before, repeated, leaves_of(frame.tree, format.depth), format.depth);
    return frame;
}

namespace {

// The planes of a frame that is being decoded, of the leaves of a tree: the frame's or a coarser one.
class PlanesReader {
  public:
    PlanesReader(const FrameShape& shape, const Octree& tree, const PlaneStreams& streams, const Tables& tables,
                 const Format& format, const InParts& in_parts)
        : shape_(shape),
          tree_(tree),
          streams_(streams),
          tables_(tables),
          depth_(format.depth),
          planes_(planes_of(format.degree)),
          in_parts_(in_parts),
          decoded_(planes_) {
        for (const auto* all : {&streams.coarse, &streams.fine})
            for (const auto& stream : *all)
                if (tree_.leaf_count == 0 && !stream.empty()) throw std::runtime_error("has planes without leaves");
    }

    // Of the leaves that are not repeated. `areas` are those of a coarser tree.
    Planes read(std::span<const int32_t> areas = {}) {
        if (tree_.leaf_count == 0) return std::move(decoded_);
        decode_planes(Pairs(tree_, areas), kOpacityPlane, 1);
        std::vector<int32_t> factors = colour_factors_of(decoded_[kOpacityPlane]);
        for (size_t leaf = 0; leaf < areas.size(); ++leaf) factors[leaf] *= areas[leaf];
        decode_colours(Pairs(tree_, factors, 1.0 / kUnit));
        return std::move(decoded_);
    }

  private:
    // The planes of colours do not need each other: those of the mean, then those of harmonics.
    void decode_colours(const Pairs& pairs) {
        in_parts_(planes_ - kFirstColourPlane, kPlanesOfMean - kFirstColourPlane, [&](size_t begin, size_t end) {
            const auto first = kFirstColourPlane + static_cast<uint32_t>(begin),
                       last = kFirstColourPlane + static_cast<uint32_t>(end);
            const uint32_t middle = std::min(std::max(first, kPlanesOfMean), last);
            if (first < middle) decode_planes(pairs, first, middle - first);
            if (middle < last) decode_planes(pairs, middle, last - middle);
        });
    }

    // Decodes `count` planes from `first` on, which are all in the same parts.
    void decode_planes(const Pairs& pairs, uint32_t first, uint32_t count) {
        std::vector<PlaneOfTree> own;
        for (uint32_t plane = first; plane < first + count; ++plane) {
            decoded_[plane].resize(tree_.leaf_count);
            own.push_back({plane,
                           static_cast<float>(shape_.roots[plane]),
                           static_cast<float>(shape_.steps[kind_of(plane)]),
                           {},
                           decoded_[plane]});
        }
        const bool is_mean = first < kPlanesOfMean;
        const auto readers_of = [&](const auto& streams, Part part) {
            std::vector<SymbolReader> readers;
            for (uint32_t plane = first; part <= streams_.last && plane < first + count; ++plane)
                readers.emplace_back(streams[plane], tables_);
            return readers;
        };
        std::vector<SymbolReader> coarse = readers_of(streams_.coarse, is_mean ? kCoarse : kShCoarse);
        std::vector<SymbolReader> fine = readers_of(streams_.fine, is_mean ? kFine : kShFine);
        if (coarse.empty() && fine.empty()) {  // all coefficients are 0
            for (const PlaneOfTree& plane : own)
                std::fill(plane.leaves.begin(), plane.leaves.end(), rounded_value(plane.root, plane.number));
            return;
        }
        code_planes<SymbolReader>(coarse, fine, tree_, pairs, depth_, own);
        const bool reads_all = tree_.cells.size() + 1 >= depth_;  // of the streams that there are
        for (const auto* readers : {&coarse, &fine})
            for (const SymbolReader& reader : *readers)
                if (reads_all && !reader.ends_well() && !(streams_.may_end_early && reader.is_over()))
                    throw std::runtime_error("has a damaged plane");
    }

    const FrameShape& shape_;
    const Octree& tree_;
    const PlaneStreams& streams_;
    const Tables& tables_;
    uint32_t depth_, planes_;
    const InParts& in_parts_;
    Planes decoded_;
};

}  // namespace

PlaneStreams plane_streams(const PartBytes& bytes, Part last, const Format& format) {
    const uint32_t planes = planes_of(format.degree);
    using Streams = std::vector<std::span<const uint8_t>>;
    PlaneStreams all{last, Streams(planes), Streams(planes)};
    for (const Part part : {kCoarse, kShCoarse, kFine, kShFine}) {
        if (part > last) break;
        const auto [first, end] = planes_of_part(part, planes);
        ByteReader reader(bytes[part]);
        std::vector<uint64_t> lengths;
        for (uint32_t plane = first; plane < end; ++plane) lengths.push_back(reader.number(4));
        Streams& streams = part == kCoarse || part == kShCoarse ? all.coarse : all.fine;
        for (uint32_t plane = first; plane < end; ++plane) streams[plane] = reader.take(lengths[plane - first]);
        reader.expect_end();
    }
    return all;
}

Planes decode_planes(const FrameShape& shape, const PlaneStreams& streams, const Tables& tables, const Format& format,
                     const QuantisedSlice* before, const InParts& in_parts) {
    return merge_planes(shape.merged, before ? &before->planes : nullptr,
                        PlanesReader(shape, shape.tree, streams, tables, format, in_parts).read());
}

QuantisedSlice decode_coarser(const FrameShape& shape, PlaneStreams streams, const Tables& tables, const Format& format,
                              uint32_t levels, const QuantisedSlice* before) {
    streams.last = std::min(streams.last, kShCoarse);
    CoarserOctree own;
    if (shape.tree.leaf_count > 0) own = coarser_octree(shape.tree, levels);
    Planes planes = PlanesReader(shape, own.tree, streams, tables, format, in_one_part).read(own.areas);
    std::vector<int16_t>& opacity = planes[kOpacityPlane];
    for (size_t i = 0; i < opacity.size(); ++i) opacity[i] = opacity_of_coarser(opacity[i], own.areas[i], levels);
    std::vector<Leaf> own_leaves = leaves_of(own.tree, format.depth - levels);
    for (Leaf& leaf : own_leaves) leaf.cell <<= 3 * levels;
    static const std::vector<Leaf> kNoLeaves;
    const std::vector<Leaf>& leaves_before = shape.is_key ? kNoLeaves : before->leaves;
    MergedLeaves merged =
        merge_leaves(leaves_before, leaves_in(leaves_before, shape.repeats), std::move(own_leaves), format.depth);
    planes = merge_planes(merged, before ? &before->planes : nullptr, std::move(planes));
    return {format.depth, format.degree, std::move(merged.leaves), std::move(planes)};
}

QuantisedSlice decode(const FrameBytes& frame, Part last, const Tables& tables, const Format& format,
                      const QuantisedSlice* before) {
    FrameShape shape = decode_shape(frame.parts[kShape], tables, format, before ? &before->leaves : nullptr);
    PartBytes bytes;
    for (uint32_t part = 0; part <= last; ++part) bytes[part] = frame.parts[part];
    Planes planes = decode_planes(shape, plane_streams(bytes, last, format), tables, format, before);
    return {format.depth, format.degree, std::move(shape.merged.leaves), std::move(planes)};
}

}  // namespace neuvv::stream

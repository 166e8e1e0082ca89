#include "stream/codec/group_decoder.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <exception>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "stream/codec/frame_decoder.h"
#include "stream/codec/group_slice.h"
#include "stream/codec/symbols.h"

static_assert(sizeof(NeuvvLeaf) == sizeof(neuvv::stream::Leaf) &&
              offsetof(NeuvvLeaf, depth) == offsetof(neuvv::stream::Leaf, depth));

struct NeuvvGroupDecoder {
    neuvv::stream::Tables tables;
    neuvv::stream::Format format;
    uint32_t budget = 0, coarser = 0;                   // leaves, 0: no limit; levels, of the frame decoded last
    std::optional<neuvv::stream::QuantisedSlice> last;  // the frame that was decoded last; none after an error
    std::vector<neuvv::stream::Leaf> last_leaves;       // that it has in the stream, where those of `last` are larger
    uint32_t last_parts = 0;
    std::optional<neuvv::stream::FrameShape> shape;  // of the frame after it, until its planes are decoded
    std::array<char, 100> error{};
};

namespace neuvv::stream {
namespace {

PartBytes c_parts_of(std::span<const uint8_t> bytes, const uint32_t* part_bytes, uint32_t parts) {
    if (parts < 1 || parts > kParts) throw std::runtime_error("has no such number of parts");
    PartBytes spans;
    for (uint32_t part = 0; part < parts; ++part) {
        if (part_bytes[part] > bytes.size()) throw std::runtime_error("ends early");
        spans[part] = bytes.first(part_bytes[part]);
        bytes = bytes.subspan(part_bytes[part]);
    }
    return spans;
}

void decode_next_shape(NeuvvGroupDecoder& group, const PartBytes& bytes, uint32_t /*parts*/) {
    const std::vector<Leaf>* before = nullptr;
    if (group.last) before = group.coarser ? &group.last_leaves : &group.last->leaves;
    group.shape = decode_shape(bytes[kShape], group.tables, group.format, before);
}

void decode_streams(NeuvvGroupDecoder& group, const PlaneStreams& streams) {
    const QuantisedSlice* before = group.last ? &*group.last : nullptr;
    if (group.shape->is_key) group.coarser = coarser_levels(group.shape->tree, group.budget);
    std::vector<Leaf>& leaves = group.shape->merged.leaves;
    if (group.coarser) {
        group.last = decode_coarser(*group.shape, streams, group.tables, group.format, group.coarser, before);
        group.last_leaves = std::move(leaves);
    } else {
        Planes planes = decode_planes(*group.shape, streams, group.tables, group.format, before);
        group.last = {group.format.depth, group.format.degree, std::move(leaves), std::move(planes)};
    }
    group.shape.reset();
}

void decode_next_planes(NeuvvGroupDecoder& group, const PartBytes& bytes, uint32_t parts) {
    if (!group.shape) throw std::runtime_error("has no shape yet");
    if (!group.shape->is_key && parts != group.last_parts)
        throw std::runtime_error("needs as many parts as the frame before it");
    decode_streams(group, plane_streams(bytes, static_cast<Part>(parts - 1), group.format));
    group.last_parts = parts;
}

// `bytes` has what is there of the coarse part.
void decode_beginnings(NeuvvGroupDecoder& group, const PartBytes& bytes, uint32_t) {
    if (!group.shape || !group.shape->is_key) throw std::runtime_error("is no key frame, or has no shape yet");
    PlaneStreams streams = plane_streams(bytes, kCoarse, group.format);
    streams.may_end_early = true;
    decode_streams(group, streams);
    group.last_parts = 0;  // nothing can repeat them
}

using Step = void(NeuvvGroupDecoder& group, const PartBytes& bytes, uint32_t parts);

// Takes the steps. Returns how many leaves the frame has, or −1 where one of them threw.
int32_t leaves_after(NeuvvGroupDecoder* group, std::span<const uint8_t> bytes, const uint32_t* part_bytes,
                     uint32_t parts, std::initializer_list<Step*> steps) {
    if (!group) return -1;
    try {
        group->error = {};
        const PartBytes spans = c_parts_of(bytes, part_bytes, parts);
        for (Step* step : steps) step(*group, spans, parts);
        return static_cast<int32_t>((group->shape ? group->shape->merged.leaves : group->last->leaves).size());
    } catch (const std::exception& problem) {
        group->last.reset();
        group->shape.reset();
        std::strncpy(group->error.data(), problem.what(), group->error.size() - 1);
        return -1;
    }
}

}  // namespace

const QuantisedSlice* last_slice(const NeuvvGroupDecoder* decoder) {
    return decoder && decoder->last ? &*decoder->last : nullptr;
}

}  // namespace neuvv::stream

NeuvvGroupDecoder* neuvv_group_new(const uint8_t* tables, size_t table_bytes, uint32_t depth, uint32_t degree,
                                   uint32_t most_leaves, uint32_t budget) {
    using namespace neuvv::stream;
    if (depth < 2 || depth > kMaxDepth || depth % 2 != 0 || degree > kMaxDegree || most_leaves > kMaxStreamLeaves)
        return nullptr;
    try {
        return std::make_unique<NeuvvGroupDecoder>(
                   NeuvvGroupDecoder{
                       read_tables({tables, table_bytes}), {depth, degree, most_leaves}, budget, 0, {}, {}, 0, {}, {}})
            .release();
    } catch (const std::exception&) {
        return nullptr;
    }
}

void neuvv_group_free(NeuvvGroupDecoder* decoder) {
    const std::unique_ptr<NeuvvGroupDecoder> owner(decoder);
}

int32_t neuvv_group_decode(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                           const uint32_t* part_bytes, uint32_t parts) {
    using namespace neuvv::stream;
    return leaves_after(decoder, {bytes, byte_count}, part_bytes, parts, {decode_next_shape, decode_next_planes});
}
int32_t neuvv_group_decode_shape(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                                 const uint32_t* part_bytes, uint32_t parts) {
    return neuvv::stream::leaves_after(decoder, {bytes, byte_count}, part_bytes, parts,
                                       {neuvv::stream::decode_next_shape});
}
int32_t neuvv_group_decode_planes(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                                  const uint32_t* part_bytes, uint32_t parts) {
    return neuvv::stream::leaves_after(decoder, {bytes, byte_count}, part_bytes, parts,
                                       {neuvv::stream::decode_next_planes});
}

uint32_t neuvv_group_coarser(const NeuvvGroupDecoder* decoder) {
    return decoder ? decoder->coarser : 0;
}

int32_t neuvv_group_decode_beginnings(NeuvvGroupDecoder* decoder, const uint8_t* bytes, size_t byte_count,
                                      const uint32_t* part_bytes) {
    using namespace neuvv::stream;
    return leaves_after(decoder, {bytes, byte_count}, part_bytes, 2, {decode_beginnings});
}

const NeuvvLeaf* neuvv_group_leaves(const NeuvvGroupDecoder* decoder) {
    if (!decoder || !decoder->last || decoder->last->leaves.empty()) return nullptr;
    return reinterpret_cast<const NeuvvLeaf*>(decoder->last->leaves.data());
}

const int16_t* neuvv_group_plane(const NeuvvGroupDecoder* decoder, uint32_t plane) {
    if (!decoder || !decoder->last || plane >= decoder->last->planes.size() || decoder->last->planes[plane].empty())
        return nullptr;
    return decoder->last->planes[plane].data();
}

const char* neuvv_group_error(const NeuvvGroupDecoder* decoder) {
    return decoder ? decoder->error.data() : "there is no group";
}

#include "stream/codec/group_decoder.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <exception>
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
    std::optional<neuvv::stream::QuantisedSlice> last;  // the frame that was decoded last; none after an error
    uint32_t last_parts = 0;
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

QuantisedSlice decoded_next(const NeuvvGroupDecoder& group, const PartBytes& bytes, uint32_t parts) {
    FrameShape shape =
        decode_shape(bytes[kShape], group.tables, group.format, group.last ? &group.last->leaves : nullptr);
    if (!shape.is_key && parts != group.last_parts)
        throw std::runtime_error("needs as many parts as the frame before it");
    Planes planes = decode_planes(shape, bytes, static_cast<Part>(parts - 1), group.tables, group.format,
                                  group.last ? &*group.last : nullptr);
    return {group.format.depth, group.format.degree, std::move(shape.merged.leaves), std::move(planes)};
}

}  // namespace

const QuantisedSlice* last_slice(const NeuvvGroupDecoder* decoder) {
    return decoder && decoder->last ? &*decoder->last : nullptr;
}

}  // namespace neuvv::stream

NeuvvGroupDecoder* neuvv_group_new(const uint8_t* tables, size_t table_bytes, uint32_t depth, uint32_t degree,
                                   uint32_t most_leaves) {
    using namespace neuvv::stream;
    if (depth < 2 || depth > kMaxDepth || depth % 2 != 0 || degree > kMaxDegree || most_leaves > kMaxStreamLeaves)
        return nullptr;
    try {
        return std::make_unique<NeuvvGroupDecoder>(
                   NeuvvGroupDecoder{read_tables({tables, table_bytes}), {depth, degree, most_leaves}, {}, 0, {}})
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
    if (!decoder) return -1;
    try {
        decoder->error = {};
        neuvv::stream::QuantisedSlice slice = neuvv::stream::decoded_next(
            *decoder, neuvv::stream::c_parts_of({bytes, byte_count}, part_bytes, parts), parts);
        decoder->last = std::move(slice);
        decoder->last_parts = parts;
        return static_cast<int32_t>(decoder->last->leaves.size());
    } catch (const std::exception& problem) {
        decoder->last.reset();
        std::strncpy(decoder->error.data(), problem.what(), decoder->error.size() - 1);
        return -1;
    }
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

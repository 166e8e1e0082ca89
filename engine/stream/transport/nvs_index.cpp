#include "stream/transport/nvs_index.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>

#include "stream/codec/bytes.h"

namespace neuvv::stream {

namespace {

constexpr uint32_t kVersion = 3, kVersionWithoutFilled = 2;
// Bytes in the header: of a group, of a frame, and of the check at the end.
constexpr uint64_t kGroupBytes = 88, kGroupBytesWithoutFilled = 64, kFrameBytes = 4 + 8 * kParts, kCheckBytes = 4;
constexpr float kLeastBox = 1e-6f;  // metres

void append_float(std::vector<uint8_t>& bytes, float number) {
    append_number(bytes, std::bit_cast<uint32_t>(number), 4);
}

float read_float(ByteReader& reader) {
    return std::bit_cast<float>(static_cast<uint32_t>(reader.number(4)));
}

// The frame stands in bytes that readers ignored before: of the header, and of the first group.
void append_origin_xy(std::vector<uint8_t>& bytes, const CaptureFrame& frame) {
    append_number(bytes, static_cast<uint32_t>(frame.origin[0]), 4);
    append_number(bytes, static_cast<uint32_t>(frame.origin[1]), 4);
}

void append_origin_z_and_scale(std::vector<uint8_t>& bytes, const CaptureFrame& frame) {
    append_number(bytes, static_cast<uint32_t>(frame.origin[2]), 4);
    append_number(bytes, static_cast<uint16_t>(frame.step), 2);
    append_number(bytes, static_cast<uint16_t>(frame.unit), 2);
}

void append_group(std::vector<uint8_t>& bytes, const Group& group, const CaptureFrame& frame) {
    append_number(bytes, group.frames, 4);
    append_number(bytes, group.format.depth, 4);
    append_number(bytes, group.format.degree, 4);
    append_number(bytes, group.format.most_leaves, 4);
    for (const float number : group.box_min) append_float(bytes, number);
    for (const float number : group.box_size) append_float(bytes, number);
    append_number(bytes, group.offset, 8);
    append_number(bytes, group.table_bytes, 4);
    append_number(bytes, group.table_check, 4);
    append_origin_z_and_scale(bytes, frame);
    const BoxPart filled = group.filled.value_or(BoxPart{{}, {1, 1, 1}});
    for (const float number : filled.low) append_float(bytes, number);
    for (const float number : filled.high) append_float(bytes, number);
}

int32_t read_coordinate(ByteReader& reader) {
    return static_cast<int32_t>(reader.number(4));
}

int16_t read_exponent(ByteReader& reader) {
    const auto exponent = static_cast<int16_t>(reader.number(2));
    if (std::abs(exponent) > CaptureFrame::kMostExponent)
        throw BadHeader("the index", "says no place of a capture", kPublishAgain);
    return exponent;
}

// `frame`: that of the first group; others have 8 bytes that are ignored.
Group read_group(ByteReader& reader, bool has_filled, CaptureFrame* frame) {
    Group group;
    group.frames = static_cast<uint32_t>(reader.number(4));
    group.format.depth = static_cast<uint32_t>(reader.number(4));
    group.format.degree = static_cast<uint32_t>(reader.number(4));
    group.format.most_leaves = static_cast<uint32_t>(reader.number(4));
    for (float& number : group.box_min) number = read_float(reader);
    for (float& number : group.box_size) number = read_float(reader);
    group.offset = reader.number(8);
    group.table_bytes = static_cast<uint32_t>(reader.number(4));
    group.table_check = static_cast<uint32_t>(reader.number(4));
    if (frame) {
        frame->origin[2] = read_coordinate(reader);
        frame->step = read_exponent(reader);
        frame->unit = read_exponent(reader);
    } else {
        reader.number(8);
    }
    if (has_filled) {
        group.filled.emplace();
        for (float& number : group.filled->low) number = read_float(reader);
        for (float& number : group.filled->high) number = read_float(reader);
    }
    return group;
}

// Nothing, or as large as a leaf.
bool may_be_filled(const BoxPart& part) {
    constexpr float kLeast = 1.0f / (1u << kMaxDepth);
    const auto is_zero = [](float number) { return number == 0; };
    if (std::ranges::all_of(part.low, is_zero) && std::ranges::all_of(part.high, is_zero)) return true;
    for (size_t axis = 0; axis < 3; ++axis)
        if (!(part.low[axis] >= 0) || !(part.high[axis] <= 1) || !(part.high[axis] - part.low[axis] >= kLeast))
            return false;
    return true;
}

// Throws where the numbers of a group are out of bounds.
void expect_sound(const Group& group, const Index& index, uint64_t offset) {
    const auto fail = [&](const char* problem) {
        throw BadHeader(fmt::format("the group of frame {}", group.first), problem, kPublishAgain);
    };
    if (group.frames < 1 || group.frames > kMaxGroupFrames || group.first + group.frames > index.frames.size())
        fail("has a number of frames that cannot be");
    if (group.format.depth < 2 || group.format.depth > kMaxDepth || group.format.depth % 2 != 0 ||
        group.format.degree > kMaxDegree || group.format.most_leaves > kMaxStreamLeaves)
        fail("has a form that this program does not know");
    for (size_t axis = 0; axis < 3; ++axis)
        if (!std::isfinite(group.box_min[axis]) || !(group.box_size[axis] >= kLeastBox) ||
            !std::isfinite(group.box_min[axis] + group.box_size[axis]))
            fail("has a box that cannot be");
    if (group.filled && !may_be_filled(*group.filled)) fail("has leaves in a box that cannot be");
    if (group.offset != offset) fail("does not begin where the one before ends");
    if (!index.frames[group.first].is_key) fail("does not begin with a key frame");
}

// Sets the first frame of each group. Throws where the groups do not follow each other to the end of the file.
void link_groups(Index& index, uint64_t header_size, uint64_t file_bytes) {
    uint32_t first = 0;
    uint64_t offset = header_size;
    for (Group& group : index.groups) {
        group.first = first;
        expect_sound(group, index, offset);
        offset += group.table_bytes;
        for (uint32_t i = 0; i < group.frames; ++i) offset += index.frames[first + i].all_bytes();
        first += group.frames;
    }
    if (first != index.frames.size()) throw BadHeader("the index", "has frames without a group", kPublishAgain);
    if (offset != file_bytes)
        throw BadHeader("", fmt::format("has {} bytes, not {}", file_bytes, offset), kPublishAgain);
}

}  // namespace

uint32_t check_of(std::span<const uint8_t> bytes) {
    return static_cast<uint32_t>(crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
}

uint64_t FrameEntry::all_bytes() const {
    return std::accumulate(bytes.begin(), bytes.end(), uint64_t{0});
}

uint32_t Index::key_of(uint32_t frame) const {
    while (!frames[frame].is_key) --frame;
    return frame;
}

uint32_t Index::group_of(uint32_t frame) const {
    const auto after = std::ranges::upper_bound(groups, frame, {}, &Group::first);
    return static_cast<uint32_t>(after - groups.begin()) - 1;
}

ByteRange Index::place_of(uint32_t frame, Part part) const {
    const uint32_t group_index = group_of(frame);
    const Group& group = groups[group_index];
    uint64_t offset = part == kShape ? group.offset + group.table_bytes
                                     : place_of_group(group_index, static_cast<Part>(part - 1)).end();
    for (uint32_t before = group.first; before < frame; ++before) offset += frames[before].bytes[part];
    return {offset, frames[frame].bytes[part]};
}

ByteRange Index::place_of_group(uint32_t group_index, Part last) const {
    const Group& group = groups[group_index];
    ByteRange range{group.offset, group.table_bytes};
    for (uint32_t frame = group.first; frame < group.first + group.frames; ++frame)
        for (uint32_t part = 0; part <= last; ++part) range.count += frames[frame].bytes[part];
    return range;
}

uint64_t header_bytes(uint64_t groups, uint64_t frames) {
    return kFixedBytes + groups * kGroupBytes + frames * kFrameBytes + kCheckBytes;
}

std::vector<uint8_t> bytes_of(const Index& index) {
    std::vector<uint8_t> bytes(kMagic, kMagic + sizeof kMagic);
    append_number(bytes, kVersion, 4);
    append_number(bytes, index.frames.size(), 4);
    append_number(bytes, index.groups.size(), 4);
    append_float(bytes, index.fps);
    append_origin_xy(bytes, index.capture);
    for (size_t i = 0; i < index.groups.size(); ++i)
        append_group(bytes, index.groups[i], i == 0 ? index.capture : CaptureFrame{});
    for (const FrameEntry& frame : index.frames) {
        append_number(bytes, frame.is_key ? 1 : 0, 4);
        for (const uint32_t count : frame.bytes) append_number(bytes, count, 4);
        for (const uint32_t check : frame.checks) append_number(bytes, check, 4);
    }
    append_number(bytes, check_of(bytes), 4);
    return bytes;
}

uint64_t read_header_size(std::span<const uint8_t> fixed) {
    ByteReader reader{fixed.subspan(sizeof kMagic)};
    const uint64_t version = reader.number(4), frames = reader.number(4), groups = reader.number(4);
    if (version != kVersion && version != kVersionWithoutFilled)
        throw BadHeader("the header", fmt::format("is of version {}", version),
                        version < kVersionWithoutFilled ? kPublishAgain : "open it with a newer neuvv");
    const float fps = read_float(reader);
    if (frames < 1 || frames > kMaxStreamFrames || groups < 1 || groups > frames || !(fps >= 1e-3f) || !(fps <= 1e4f))
        throw BadHeader("the header", "has numbers that cannot be", kPublishAgain);
    const uint64_t less = version == kVersion ? 0 : kGroupBytes - kGroupBytesWithoutFilled;
    return header_bytes(groups, frames) - groups * less;
}

Index read_index(std::span<const uint8_t> header, uint64_t file_bytes) {
    const std::span<const uint8_t> checked = header.first(header.size() - kCheckBytes);
    if (ByteReader(header.last(kCheckBytes)).number(4) != check_of(checked))
        throw BadHeader("the index", "is damaged", kPublishAgain);
    ByteReader reader(checked.subspan(sizeof kMagic));
    const bool has_filled = reader.number(4) != kVersionWithoutFilled;
    Index index;
    index.frames.resize(reader.number(4));
    index.groups.resize(reader.number(4));
    index.fps = read_float(reader);
    index.capture.origin[0] = read_coordinate(reader);
    index.capture.origin[1] = read_coordinate(reader);
    for (size_t i = 0; i < index.groups.size(); ++i)
        index.groups[i] = read_group(reader, has_filled, i == 0 ? &index.capture : nullptr);
    for (FrameEntry& frame : index.frames) {
        const uint64_t flag = reader.number(4);
        if (flag > 1)
            throw BadHeader("the index", "has frames of a kind that this program does not know", kPublishAgain);
        frame.is_key = flag == 1;
        for (uint32_t& count : frame.bytes) count = static_cast<uint32_t>(reader.number(4));
        for (uint32_t& check : frame.checks) check = static_cast<uint32_t>(reader.number(4));
    }
    link_groups(index, header.size(), file_bytes);
    return index;
}

}  // namespace neuvv::stream

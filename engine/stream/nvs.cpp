#include "stream/nvs.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

#include "base/error.h"
#include "base/platform.h"
#include "stream/bytes.h"

namespace neuvv::stream {

namespace {

constexpr char kMagic[8] = {'N', 'V', 'S', 't', 'r', 'e', 'a', 'm'};
constexpr uint32_t kVersion = 1;
// Bytes of the head: of its fixed part, of a group, of a frame, and of the check at the end.
constexpr uint64_t kFixedBytes = 32, kGroupBytes = 64, kFrameBytes = 8 * kParts, kCheckBytes = 4;
constexpr float kLeastBox = 1e-6f;  // metres
constexpr const char* kFix = "publish the clip again";

uint32_t check_of(std::span<const uint8_t> bytes) {
    return static_cast<uint32_t>(crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
}

void append_float(std::vector<uint8_t>& bytes, float number) {
    append_number(bytes, std::bit_cast<uint32_t>(number), 4);
}

float read_float(ByteReader& reader) {
    return std::bit_cast<float>(static_cast<uint32_t>(reader.number(4)));
}

std::vector<uint8_t> head_of(const Index& index) {
    std::vector<uint8_t> bytes(kMagic, kMagic + sizeof kMagic);
    append_number(bytes, kVersion, 4);
    append_number(bytes, index.frames.size(), 4);
    append_number(bytes, index.groups.size(), 4);
    append_float(bytes, index.fps);
    append_number(bytes, 0, 8);
    for (const Group& group : index.groups) {
        append_number(bytes, group.frames, 4);
        append_number(bytes, group.format.depth, 4);
        append_number(bytes, group.format.degree, 4);
        append_number(bytes, group.format.most_leaves, 4);
        for (const float number : group.box_min) append_float(bytes, number);
        for (const float number : group.box_size) append_float(bytes, number);
        append_number(bytes, group.offset, 8);
        append_number(bytes, group.table_bytes, 4);
        append_number(bytes, group.table_check, 4);
        append_number(bytes, 0, 8);
    }
    for (const FrameEntry& frame : index.frames) {
        for (const uint32_t end : frame.ends) append_number(bytes, end, 4);
        for (const uint32_t check : frame.checks) append_number(bytes, check, 4);
    }
    append_number(bytes, check_of(bytes), 4);
    return bytes;
}

// Throws std::runtime_error where the numbers of a group are out of bounds.
void expect_sound(const Group& group, const Index& index, uint64_t offset) {
    if (group.frames < 1 || group.frames > kMaxGroupFrames || group.first + group.frames > index.frames.size())
        throw std::runtime_error("has a number of frames that cannot be");
    if (group.format.depth < 2 || group.format.depth > kMaxDepth || group.format.depth % 2 != 0 ||
        group.format.degree > kMaxDegree || group.format.most_leaves > kMaxStreamLeaves)
        throw std::runtime_error("has a form that this program does not know");
    for (size_t axis = 0; axis < 3; axis++)
        if (!std::isfinite(group.box_min[axis]) || !(group.box_size[axis] >= kLeastBox) ||
            !std::isfinite(group.box_min[axis] + group.box_size[axis]))
            throw std::runtime_error("has a box that cannot be");
    if (group.offset != offset) throw std::runtime_error("does not begin where the one before ends");
}

void expect_sound(const FrameEntry& frame) {
    for (size_t part = 1; part < kParts; part++)
        if (frame.ends[part] < frame.ends[part - 1]) throw std::runtime_error("ends before its parts do");
}

Group read_group(ByteReader& reader) {
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
    reader.number(8);
    return group;
}

std::vector<uint8_t> deflated(const std::vector<uint8_t>& bytes) {
    uLongf count = compressBound(static_cast<uLong>(bytes.size()));
    std::vector<uint8_t> result(count);
    if (compress2(result.data(), &count, bytes.data(), static_cast<uLong>(bytes.size()), 9) != Z_OK)
        throw std::bad_alloc();
    result.resize(count);
    return result;
}

std::vector<uint8_t> inflated(std::span<const uint8_t> bytes, size_t count) {
    std::vector<uint8_t> result(count);
    auto written = static_cast<uLongf>(count);
    auto taken = static_cast<uLong>(bytes.size());
    if (uncompress2(result.data(), &written, bytes.data(), &taken) != Z_OK || written != count || taken != bytes.size())
        throw std::runtime_error("has damaged tables");
    return result;
}

}  // namespace

uint64_t head_bytes(uint64_t groups, uint64_t frames) {
    return kFixedBytes + groups * kGroupBytes + frames * kFrameBytes + kCheckBytes;
}

uint32_t Index::group_of(uint32_t frame) const {
    const auto after = std::ranges::upper_bound(groups, frame, {}, &Group::first);
    return static_cast<uint32_t>(after - groups.begin()) - 1;
}

uint64_t Index::offset_of(uint32_t frame) const {
    const Group& group = groups[group_of(frame)];
    uint64_t offset = group.offset + group.table_bytes;
    for (uint32_t before = group.first; before < frame; before++) offset += frames[before].ends.back();
    return offset;
}

bool is_stream(const std::filesystem::path& path) {
    if (is_address(path)) return true;
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    char magic[sizeof kMagic] = {};
    std::ifstream(path, std::ios::binary).read(magic, sizeof magic);
    return std::memcmp(magic, kMagic, sizeof magic) == 0;
}

void Reader::fail(const std::string& place, const std::string& problem) const {
    failed_ = true;
    throw InputError(path_.string(), place, problem, kFix);
}

void Reader::cancel() {
    failed_ = true;
    source_->cancel();
}

std::vector<uint8_t> Reader::bytes_at(uint64_t offset, uint64_t count, const std::string& place) {
    if (count > source_->size() || offset > source_->size() - count) fail(place, "lies beyond the end of the file");
    try {
        return source_->read(offset, count);
    } catch (const ServerProblem&) {
        throw;
    } catch (const InputError&) {
        failed_ = true;
        throw;
    }
}

Reader::Reader(const std::filesystem::path& path) : path_(path) {
    const auto expect_stream = [&](bool is) {
        if (!is) throw InputError(path_.string(), "", "is no stream", "name a .nvs of `neuvv publish`");
    };
    expect_stream(is_stream(path_));
    source_ = open_source(path_);
    const std::vector<uint8_t> fixed = bytes_at(0, kFixedBytes, "the head");
    expect_stream(std::memcmp(fixed.data(), kMagic, sizeof kMagic) == 0);
    ByteReader reader{std::span<const uint8_t>(fixed).subspan(sizeof kMagic)};
    const uint64_t version = reader.number(4), frames = reader.number(4), groups = reader.number(4);
    if (version != kVersion)
        throw InputError(path_.string(), "the head", fmt::format("is of version {}", version),
                         "open it with a newer neuvv");
    index_.fps = read_float(reader);
    if (frames < 1 || frames > kMaxStreamFrames || groups < 1 || groups > frames || !(index_.fps >= 1e-3f) ||
        !(index_.fps <= 1e4f))
        fail("the head", "has numbers that cannot be");
    const std::vector<uint8_t> head = bytes_at(0, head_bytes(groups, frames), "the index");
    const std::span<const uint8_t> checked = std::span(head).first(head.size() - kCheckBytes);
    if (ByteReader(std::span<const uint8_t>(head).last(kCheckBytes)).number(4) != check_of(checked))
        fail("the index", "is damaged");
    ByteReader rest(checked.subspan(kFixedBytes));
    for (uint64_t i = 0; i < groups; i++) index_.groups.push_back(read_group(rest));
    index_.frames.resize(frames);
    for (FrameEntry& frame : index_.frames) {
        for (uint32_t& end : frame.ends) end = static_cast<uint32_t>(rest.number(4));
        for (uint32_t& check : frame.checks) check = static_cast<uint32_t>(rest.number(4));
    }
    uint32_t first = 0;
    uint64_t offset = head.size();
    std::string place;
    try {
        for (Group& group : index_.groups) {
            place = fmt::format("the group of frame {}", first);
            group.first = first;
            expect_sound(group, index_, offset);
            offset += group.table_bytes;
            for (uint32_t i = 0; i < group.frames; i++) {
                place = fmt::format("frame {}", first + i);
                expect_sound(index_.frames[first + i]);
                offset += index_.frames[first + i].ends.back();
            }
            first += group.frames;
        }
    } catch (const std::runtime_error& problem) {
        fail(place, problem.what());
    }
    if (first != frames) fail("the index", "has frames without a group");
    if (offset != source_->size()) fail("", fmt::format("has {} bytes, not {}", source_->size(), offset));
}

// The frames behind this one are fetched while it is decoded.
void Reader::read_ahead(uint32_t frame) {
    const auto frames = static_cast<uint32_t>(index_.frames.size());
    const auto ahead = static_cast<uint32_t>(std::ceil(kAhead_s * index_.fps));
    const uint64_t begin = index_.offset_of(frame) + index_.frames[frame].ends.back();
    const uint32_t last = ahead < frames - frame ? frame + ahead : frames - 1;
    source_->read_ahead(begin, index_.offset_of(last) + index_.frames[last].ends.back() - begin);
}

std::shared_ptr<const Slice> Reader::decode_next(uint32_t frame, Part last, const Slice* before) {
    const uint32_t number = index_.group_of(frame);
    const Group& group = index_.groups[number];
    std::string place = fmt::format("the tables of frame {}", group.first);
    try {
        if (table_group_ != number) {
            table_group_.reset();
            const std::vector<uint8_t> bytes = bytes_at(group.offset, group.table_bytes, place);
            if (check_of(bytes) != group.table_check) throw std::runtime_error("are damaged");
            tables_ = read_tables(inflated(bytes, table_bytes()));
            table_group_ = number;
        }
        place = fmt::format("frame {}", frame);
        const FrameEntry& entry = index_.frames[frame];
        const std::vector<uint8_t> bytes = bytes_at(index_.offset_of(frame), entry.ends[last], place);
        read_ahead(frame);
        for (uint32_t part = 0, begin = 0; part <= last; begin = entry.ends[part++])
            if (check_of(std::span(bytes).subspan(begin, entry.ends[part] - begin)) != entry.checks[part])
                throw std::runtime_error("is damaged");
        auto slice = std::make_shared<const Slice>(decode(bytes, last, tables_, group.format, before));
        if (kept_.size() == kKept) kept_.erase(kept_.begin());
        kept_.push_back({frame, last, slice});
        return slice;
    } catch (const InputError&) {
        throw;
    } catch (const std::runtime_error& problem) {
        fail(place, problem.what());
    }
}

std::shared_ptr<const Slice> Reader::frame(uint32_t frame, Part last) {
    const std::lock_guard lock(mutex_);
    const uint32_t first = index_.groups[index_.group_of(frame)].first;
    uint32_t next = first;
    std::shared_ptr<const Slice> slice;  // of the frame before `next`
    for (const Kept& one : kept_)
        if (one.last == last && one.frame + 1 > next && one.frame >= first && one.frame <= frame) {
            slice = one.slice;
            next = one.frame + 1;
        }
    for (; next <= frame; next++) slice = decode_next(next, last, next > first ? slice.get() : nullptr);
    return slice;
}

GroupBytes bytes_of(const std::vector<FrameSymbols>& frames) {
    Counts counts = no_counts();
    for (const FrameSymbols& frame : frames) count(frame, counts);
    const Tables tables = tables_of(counts);
    GroupBytes bytes{deflated(bytes_of(tables)), {}};
    for (const FrameSymbols& frame : frames) bytes.frames.push_back(bytes_of(frame, tables));
    return bytes;
}

uint64_t GroupBytes::count() const {
    uint64_t sum = tables.size();
    for (const FrameBytes& frame : frames) sum += frame.bytes.size();
    return sum;
}

Writer::Writer(const std::filesystem::path& path, float fps, uint32_t frames, uint32_t groups)
    : path_(link_target(path)), temporary_(path_.string() + fmt::format(".tmp{}", getpid())) {
    file_ = std::fopen(temporary_.c_str(), "wb");
    if (!file_) throw RuntimeFailure(fmt::format("{}: cannot be made: {}", temporary_.string(), std::strerror(errno)));
    index_.fps = fps;
    index_.frames.reserve(frames);
    index_.groups.reserve(groups);
    try {
        write(std::vector<uint8_t>(head_bytes(groups, frames)));
    } catch (...) {
        remove_unfinished();
        throw;
    }
}

Writer::~Writer() {
    remove_unfinished();
}

void Writer::remove_unfinished() {
    if (file_) std::fclose(std::exchange(file_, nullptr));
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void Writer::write(const std::vector<uint8_t>& bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size())
        throw RuntimeFailure(fmt::format("{}: cannot be written: {}", temporary_.string(), std::strerror(errno)));
    next_ += bytes.size();
}

uint64_t Writer::add(Group group, const std::vector<FrameSymbols>& frames) {
    const GroupBytes bytes = bytes_of(frames);
    group.first = static_cast<uint32_t>(index_.frames.size());
    group.frames = static_cast<uint32_t>(frames.size());
    group.offset = next_;
    group.table_bytes = static_cast<uint32_t>(bytes.tables.size());
    group.table_check = check_of(bytes.tables);
    write(bytes.tables);
    for (const FrameBytes& frame : bytes.frames) {
        FrameEntry& entry = index_.frames.emplace_back();
        entry.ends = frame.ends;
        for (uint32_t part = 0, begin = 0; part < kParts; begin = entry.ends[part++])
            entry.checks[part] = check_of(std::span(frame.bytes).subspan(begin, entry.ends[part] - begin));
        write(frame.bytes);
    }
    index_.groups.push_back(group);
    return next_ - group.offset + head_bytes(1, frames.size());
}

uint64_t Writer::finish() {
    const uint64_t bytes = next_;
    assert(head_bytes(index_.groups.size(), index_.frames.size()) == index_.groups[0].offset &&
           "as many groups and frames as the constructor was told");
    std::rewind(file_);
    write(head_of(index_));
    const bool closed = std::fclose(std::exchange(file_, nullptr)) == 0;
    if (!closed) throw RuntimeFailure(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
    replace_file(path_, temporary_);
    return bytes;
}

}  // namespace neuvv::stream

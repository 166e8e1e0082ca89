#include "stream/transport/nvs_reader.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/seconds.h"
#include "base/threads/parallel.h"
#include "base/trace_file.h"

namespace neuvv::stream {

namespace {

std::vector<uint8_t> inflated(std::span<const uint8_t> bytes, size_t count) {
    std::vector<uint8_t> result(count);
    auto written = static_cast<uLongf>(count);
    auto taken = static_cast<uLong>(bytes.size());
    if (uncompress2(result.data(), &written, bytes.data(), &taken) != Z_OK || written != count || taken != bytes.size())
        throw std::runtime_error("has damaged tables");
    return result;
}

}  // namespace

uint32_t frames_at_once() {
    return std::clamp(std::thread::hardware_concurrency() / 2, 1u, 8u);
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
    source_->forget_copies();
    throw InputError(path_.string(), place, problem, kPublishAgain);
}

void Reader::cancel() {
    failed_ = true;
    source_->cancel();
}

std::vector<uint8_t> Reader::bytes_at(const ByteRange& range, const std::string& place) {
    if (range.count > source_->size() || range.offset > source_->size() - range.count)
        fail(place, "lies beyond the end of the file");
    try {
        return source_->read(range.offset, range.count);
    } catch (const ServerProblem&) {
        throw;
    } catch (const InputError&) {
        failed_ = true;
        throw;
    }
}

Reader::Reader(const std::filesystem::path& path) : path_(path) {
    const auto expect_stream = [&](bool is) {
        if (!is) throw InputError(path_.string(), "", "is no stream", Remedy::kNameStream);
    };
    expect_stream(is_stream(path_));
    source_ = open_source(path_);
    const std::vector<uint8_t> fixed = bytes_at({0, kFixedBytes}, "the header");
    expect_stream(std::memcmp(fixed.data(), kMagic, sizeof kMagic) == 0);
    try {
        index_ = read_index(bytes_at({0, read_header_size(fixed)}, "the index"), source_->size());
    } catch (const BadHeader& bad) {
        failed_ = true;
        source_->forget_copies();
        throw InputError(path_.string(), bad.place, bad.what(), bad.fix);
    }
}

void Reader::read_first_ahead() {
    std::vector<ByteRange> ranges = parts_of(0, kShFine);
    ranges.insert(ranges.begin(), {index_.groups[0].offset, index_.groups[0].table_bytes});
    source_->read_ahead(ranges);
}

std::vector<ByteRange> Reader::parts_of(uint32_t frame, Part last) const {
    std::vector<ByteRange> ranges;
    for (uint32_t part = kShape; part <= last; ++part)
        ranges.push_back(index_.place_of(frame, static_cast<Part>(part)));
    return ranges;
}

std::vector<uint8_t> Reader::part_of(uint32_t frame, Part part) {
    const std::string place = fmt::format("frame {}", frame);
    std::vector<uint8_t> bytes = bytes_at(index_.place_of(frame, part), place);
    if (check_of(bytes) != index_.frames[frame].checks[part]) fail(place, "is damaged");
    return bytes;
}

// Of the frame's group.
const Tables& Reader::tables_of(const FrameInProgress& begun) {
    const std::lock_guard lock(begun.tables->mutex);
    if (begun.tables->tables) return *begun.tables->tables;
    const Group& group = index_.groups[begun.group];
    const std::string place = fmt::format("the tables of frame {}", group.first);
    const std::vector<uint8_t> bytes = bytes_at({group.offset, group.table_bytes}, place);
    if (check_of(bytes) != group.table_check) fail(place, "are damaged");
    try {
        return begun.tables->tables.emplace(read_tables(inflated(bytes, table_bytes())));
    } catch (const std::runtime_error& problem) {
        fail(place, problem.what());
    }
}

// What is missing of the frame, of its group, and the groups behind it, are fetched while the frame is decoded.
void Reader::read_ahead(uint32_t frame, Part last) {
    std::vector<ByteRange> ranges = parts_of(frame, last);
    double ahead_s = 0;
    for (uint32_t group = index_.group_of(frame); group < index_.groups.size() && ahead_s < kAhead_s; ++group) {
        ranges.push_back(index_.place_of_group(group, last));
        const Group& one = index_.groups[group];
        ahead_s += (one.first + one.frames - std::max(frame, one.first)) / double{index_.fps};
    }
    source_->read_ahead(ranges);
}

// How many frames of a group are kept, by what the largest of them takes.
size_t Reader::kept_of(uint32_t group) const {
    const Format& format = index_.groups[group].format;
    const uint64_t leaf_bytes =
        2 * sizeof(Leaf) + sizeof(int16_t) * planes_of(format.degree);  // in shape and slice, at most
    const uint64_t frame_bytes = std::max<uint64_t>(format.most_leaves, 1) * leaf_bytes;
    const auto frames = std::span(index_.frames).subspan(index_.groups[group].first, index_.groups[group].frames);
    const bool repeats = !std::ranges::all_of(frames, &FrameEntry::is_key);
    // The reader's threads each decode one, and others may repeat it.
    const size_t least = frames_at_once() + (repeats ? 3 : 1);
    return static_cast<size_t>(std::clamp<uint64_t>(kKeptBytes / frame_bytes, least, kMostKept));
}

// `before` is the frame before it; null: it is a key frame.
std::shared_ptr<Reader::FrameInProgress> Reader::begin_next_locked(uint32_t frame, Part last,
                                                                   const std::shared_ptr<FrameInProgress>& before) {
    auto begun = std::make_shared<FrameInProgress>();
    begun->frame = frame;
    begun->group = index_.group_of(frame);
    begun->last = last;
    begun->before = before;
    if (before && before->group == begun->group) begun->tables = before->tables;
    for (const std::shared_ptr<FrameInProgress>& one : kept_)
        if (one->group == begun->group) begun->tables = one->tables;
    if (!begun->tables) begun->tables = std::make_shared<GroupTables>();
    while (kept_.size() >= kept_of(begun->group)) kept_.erase(kept_.begin());
    kept_.push_back(begun);
    return begun;
}

// Begins the frame, or one before it, so that no more frames are begun behind `known` than are kept. `known` is a frame
// that was begun for the same frame and parts; null: none was. Frames that are known are not begun again.
std::shared_ptr<Reader::FrameInProgress> Reader::begin_towards(uint32_t frame, Part last,
                                                               std::shared_ptr<FrameInProgress> known) {
    const std::lock_guard lock(mutex_);
    uint32_t next = known ? known->frame + 1 : index_.key_of(frame);
    for (const std::shared_ptr<FrameInProgress>& one : kept_)
        if (one->last == last && one->frame >= next && one->frame <= frame) {
            known = one;
            next = one->frame + 1;
        }
    const uint64_t end = std::min<uint64_t>(uint64_t{frame} + 1, uint64_t{next} + kept_of(index_.group_of(frame)));
    for (; next < end; ++next) known = begin_next_locked(next, last, known);
    return known;
}

// Whoever comes first decodes it, and those before it that are not decoded.
const FrameShape& Reader::shape_of(FrameInProgress& begun, DecodeTimes& times) {
    const auto of_frame = [&] {
        const TraceSpan span("wait for the shape of frame", begun.frame);
        return std::unique_lock(begun.shape_mutex);
    }();
    if (begun.shape) return *begun.shape;
    const FrameShape* before = begun.before ? &shape_of(*begun.before, times) : nullptr;
    const Tables& tables = tables_of(begun);
    const std::vector<uint8_t> bytes = part_of(begun.frame, kShape);
    read_ahead(begun.frame, begun.last);
    const TraceSpan span("decode the shape of frame", begun.frame);
    const double begin_s = seconds_now();
    try {
        FrameShape shape =
            decode_shape(bytes, tables, index_.groups[begun.group].format, before ? &before->merged.leaves : nullptr);
        if (shape.is_key != index_.frames[begun.frame].is_key)
            throw std::runtime_error("is a key frame or not, other than the index says");
        begun.shape = std::move(shape);
    } catch (const std::runtime_error& problem) {
        fail(fmt::format("frame {}", begun.frame), problem.what());
    }
    ++times.shapes;
    times.shapes_s += seconds_now() - begin_s;
    if (!begun.shape->merged.repeats_any) begun.before.reset();
    return *begun.shape;
}

// Where the frame repeats planes of the one before, those are decoded first, by whoever comes first.
std::shared_ptr<const QuantisedSlice> Reader::slice_of(FrameInProgress& begun, DecodeTimes& times) {
    shape_of(begun, times);
    const std::lock_guard of_frame(begun.slice_mutex);
    if (begun.slice) return begun.slice;
    const std::shared_ptr<const QuantisedSlice> before = begun.before ? slice_of(*begun.before, times) : nullptr;
    std::array<std::vector<uint8_t>, kParts> bytes;
    PartBytes parts;
    uint64_t count = 0;
    for (uint32_t part = kShape + 1; part <= begun.last; ++part) {
        bytes[part] = part_of(begun.frame, static_cast<Part>(part));
        parts[part] = bytes[part];
        count += bytes[part].size();
    }
    const Tables& tables = tables_of(begun);
    const TraceSpan span("decode the planes of frame", begun.frame);
    const double begin_s = seconds_now();
    try {
        // Of two cores, the other one draws.
        const InParts in_parts = std::thread::hardware_concurrency() > 2 ? InParts(parallel_for) : in_one_part;
        const Format& format = index_.groups[begun.group].format;
        FrameShape& shape = *begun.shape;
        Planes planes =
            decode_planes(shape, plane_streams(parts, begun.last, format), tables, format, before.get(), in_parts);
        const bool may_be_repeated = begun.frame + 1 < index_.frames.size() && !index_.frames[begun.frame + 1].is_key;
        auto slice =
            std::make_shared<QuantisedSlice>(QuantisedSlice{format.depth, format.degree, {}, std::move(planes)});
        slice->leaves = may_be_repeated ? shape.merged.leaves : std::move(shape.merged.leaves);
        begun.slice = std::move(slice);
    } catch (const std::runtime_error& problem) {
        fail(fmt::format("frame {}", begun.frame), problem.what());
    }
    times.plane_bytes += count;
    times.planes_s += seconds_now() - begin_s;
    begun.before.reset();
    begun.shape->tree = {};  // the next frame needs the leaves alone, and where it repeats none, not even these
    return begun.slice;
}

// Of the frames of the same key frame, some may have been begun that cannot be decoded now. Who tries again begins with
// the key frame, so that these do not become more and more.
void Reader::forget(uint32_t frame) {
    const std::lock_guard lock(mutex_);
    std::erase_if(kept_, [&](const auto& one) { return index_.key_of(one->frame) == index_.key_of(frame); });
}

// Frames that are passed over keep the shapes of those before them as long as their planes are not decoded. So these
// are decoded now and then.
std::shared_ptr<const QuantisedSlice> Reader::frame(uint32_t frame, Part last, DecodeTimes* times) {
    DecodeTimes taken;
    std::shared_ptr<FrameInProgress> begun;
    std::shared_ptr<const QuantisedSlice> slice;
    do {
        begun = begin_towards(frame, last, std::move(begun));
        try {
            slice = slice_of(*begun, taken);
        } catch (...) {
            forget(begun->frame);
            throw;
        }
    } while (begun->frame != frame);
    if (times) *times = taken;
    return slice;
}

GroupCost Reader::cost_of(uint32_t frame) const {
    GroupCost cost;
    cost.number = index_.group_of(frame);
    const Group& group = index_.groups[cost.number];
    for (uint32_t part = 0; part < kParts; ++part)
        cost.bytes_until[part] = index_.place_of_group(cost.number, static_cast<Part>(part)).count;
    cost.frames = group.frames;
    cost.seconds = group.frames / double{index_.fps};
    return cost;
}

}  // namespace neuvv::stream

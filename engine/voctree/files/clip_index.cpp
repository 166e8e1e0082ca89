#include "voctree/files/clip_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "voctree/files/clip.h"

namespace neuvv::voctree {

namespace {

constexpr uint64_t kIndexVersion = 2, kVersionWithoutOverlap = 1;
constexpr uint64_t kMostOverlap = 1000;  // frames

// The name of a segment's file. It must lie in the clip's own folder, so that a clip cannot name files elsewhere.
std::string file_name(const JsonNode& node) {
    const std::string& name = json_string(node);
    if (std::filesystem::path(name).filename() != name || std::filesystem::path(name).extension() != ".nvv")
        node.fail(fmt::format("\"{}\" is no name of an .nvv file in the clip's folder", name), "name a file beside it");
    return name;
}

}  // namespace

std::filesystem::path index_file(const std::filesystem::path& clip) {
    return clip / "clip.json";
}

bool is_segmented(const std::filesystem::path& clip) {
    std::error_code problem;
    return std::filesystem::is_regular_file(index_file(clip), problem);
}

std::filesystem::path clip_path(const std::filesystem::path& given) {
    return given.has_filename() || !given.has_relative_path() ? given : given.parent_path();
}

namespace {

// A stream that is open already is not opened again, unless its file has changed, or it was found to be damaged or
// changed on its server: what it has read and decoded is there.
std::shared_ptr<stream::Reader> opened_stream(const std::filesystem::path& path) {
    static std::mutex mutex;
    static std::map<std::filesystem::path, std::weak_ptr<stream::Reader>> open;
    const auto is_current = [&](const stream::Reader& reader) {
        return !reader.has_failed() && (stream::is_address(path) || reader.stamp() == neuvv::stamp_of(path));
    };
    {
        const std::lock_guard lock(mutex);
        std::erase_if(open, [](const auto& one) { return one.second.expired(); });
        if (const auto found = open.find(path); found != open.end())
            if (auto reader = found->second.lock(); reader && is_current(*reader)) return reader;
    }
    auto reader = std::make_shared<stream::Reader>(path);  // which may take as long as a server does
    const std::lock_guard lock(mutex);
    open[path] = reader;
    return reader;
}

ClipIndex index_of_stream(const std::filesystem::path& path) {
    const std::shared_ptr<stream::Reader> reader = opened_stream(path);
    ClipIndex index{reader->index().fps, {}};
    const auto frames = static_cast<uint32_t>(reader->index().frames.size());
    index.segments.reserve(frames);
    for (uint32_t frame = 0; frame < frames; ++frame)
        index.segments.push_back({path / segment_file_name(frame), frame, 1, 0, reader});
    return index;
}

}  // namespace

bool is_stream(const ClipIndex& index) {
    return index.segments[0].stream != nullptr;
}

FileStamp stamp_of(const ClipSegment& segment) {
    return segment.stream ? segment.stream->stamp() : neuvv::stamp_of(segment.file);
}

ClipIndex read_clip_index(const std::filesystem::path& clip, UpAxis up) {
    const ClipKind kind = kind_of(clip);
    if (kind == ClipKind::kStream) return index_of_stream(clip);
    if (kind != ClipKind::kSegments) {
        const ClipHeader header = read_clip_header(clip, up);
        return {header.fps, {{clip, 0, header.frames, 0, nullptr, up}}};
    }
    const JsonFile file = read_json(index_file(clip), "the index of a segmented clip");
    const JsonNode root = file.root();
    if (json_count(root["neuvv_clip"], UINT32_MAX) > kIndexVersion)
        root["neuvv_clip"].fail("is a version that this program does not know", "open the clip with a newer neuvv");
    ClipIndex index;
    index.fps = static_cast<float>(json_number(root["fps"], 1e-3, 1e4, "a frame rate"));
    const JsonNode segments = root["segments"];
    expect_list(segments);
    std::set<std::filesystem::path> files;
    uint32_t first = 0;
    for (size_t i = 0; i < segments.value.size(); ++i) {
        const JsonNode segment = segments[i];
        const auto frames = static_cast<uint32_t>(json_count(segment["frames"], kMaxClipFrames - first));
        if (frames == 0) segment["frames"].fail("is 0", "remove segments without frames");
        const uint64_t overlap = segment.has("overlap") ? json_count(segment["overlap"], kMostOverlap) : 0;
        index.segments.push_back(
            {clip / file_name(segment["file"]), first, frames, static_cast<uint32_t>(overlap), nullptr});
        if (!files.insert(index.segments.back().file).second)
            segment["file"].fail("is the file of another segment, too", "give each segment its own file");
        first += frames;
    }
    return index;
}

void write_clip_index(const std::filesystem::path& folder, const ClipIndex& index) {
    nlohmann::ordered_json segments = nlohmann::ordered_json::array();
    uint64_t version = kVersionWithoutOverlap;
    for (const ClipSegment& segment : index.segments) {
        segments.push_back({{"file", segment.file.filename().string()}, {"frames", segment.frames}});
        if (segment.overlap == 0) continue;
        segments.back()["overlap"] = segment.overlap;
        version = kIndexVersion;
    }
    write_text_file(index_file(folder),
                    json_text({{"neuvv_clip", version}, {"fps", index.fps}, {"segments", segments}}));
}

std::vector<size_t> segments_from_middle(size_t segments) {
    std::vector<size_t> order;
    const size_t middle = segments / 2;
    for (size_t i = 0; i < segments; ++i) order.push_back(i % 2 ? middle - (i + 1) / 2 : middle + i / 2);
    return order;
}

std::string segment_file_name(uint32_t first_frame) {
    return fmt::format("{:06}.nvv", first_frame);
}

SegmentFrame segment_frame(const ClipIndex& index, double frame) {
    const auto after = std::upper_bound(
        index.segments.begin(), index.segments.end(), frame,
        [](double value, const ClipSegment& segment) { return value < static_cast<double>(segment.first); });
    auto segment_index = static_cast<uint32_t>(std::max<ptrdiff_t>(after - index.segments.begin(), 1) - 1);
    const double behind = frame - (index.segments[segment_index].end() - 1);  // the segment's last frame
    const bool is_last = segment_index + 1 == index.segments.size();
    if (index.segments[segment_index].overlap == 0 && behind >= 0.5 && !is_last) ++segment_index;
    const ClipSegment& segment = index.segments[segment_index];
    const double last = (is_last ? segment.frames : segment.frames_of_file()) - 1.0;
    return {segment_index, static_cast<float>(std::clamp(frame - segment.first, 0.0, last))};
}

std::vector<SegmentShare> segment_shares(const ClipIndex& index, double frame) {
    const SegmentFrame at = segment_frame(index, frame);
    // It may fade from the segment before, or into the next: a segment has more frames than fade into it.
    for (const uint32_t next : {at.segment, at.segment + 1}) {
        if (next == 0 || next >= index.segments.size()) continue;
        const auto faded = static_cast<double>(fade_frames(index, next - 1));
        const double x = frame - index.segments[next].first;
        if (faded == 0 || x <= -1 || x >= faded) continue;
        const auto later = static_cast<float>((x + 1) / (faded + 1));
        const double in_overlap = std::min(x, faded - 1);
        const SegmentShare of_later{{next, static_cast<float>(std::max(x, 0.0))}, later};
        const SegmentShare of_earlier{{next - 1, static_cast<float>(index.segments[next - 1].frames + in_overlap)},
                                      1 - later};
        if (next == at.segment) return {of_later, of_earlier};
        return {of_earlier, of_later};
    }
    return {{at}};
}

uint32_t fade_frames(const ClipIndex& index, size_t segment) {
    if (segment + 1 >= index.segments.size()) return 0;
    return std::min(index.segments[segment].overlap, index.segments[segment + 1].frames - 1);
}

}  // namespace neuvv::voctree

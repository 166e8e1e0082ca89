#include "voctree/files/clip_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/formats/json.h"
#include "base/output_path.h"
#include "voctree/files/clip.h"
#include "voctree/kinds/nvv_source.h"
#include "voctree/kinds/plenoctree_source.h"
#include "voctree/kinds/stream_source.h"

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

ClipIndex read_segmented_index(const std::filesystem::path& clip) {
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
        index.segments.push_back({clip / file_name(segment["file"]), first, frames, static_cast<uint32_t>(overlap)});
        if (!files.insert(index.segments.back().file).second)
            segment["file"].fail("is the file of another segment, too", "give each segment its own file");
        first += frames;
    }
    return index;
}

}  // namespace

std::optional<FrameBound> ClipIndex::plays_by_frame() const {
    return segments[0].source->plays_by_frame();
}

ClipIndex read_clip_index(const std::filesystem::path& clip, UpAxis up) {
    switch (kind_of(clip)) {
        case ClipKind::kStream:
            return index_of_stream(clip);
        case ClipKind::kSegments:
            return read_segmented_index(clip);
        case ClipKind::kPlenoctree:
            return index_of_plenoctree(clip, up);
        case ClipKind::kNvv:
            break;
    }
    return index_of_nvv(clip);
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

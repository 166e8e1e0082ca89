#include "voctree/files/clip.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>

#include "base/error.h"
#include "base/platform.h"
#include "base/trace_file.h"
#include "voctree/tree_slice.h"

namespace neuvv::voctree {

namespace {

// Among clips, only PlenOctrees are zip files.
bool is_zip(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    char magic[4] = {};
    std::ifstream(path, std::ios::binary).read(magic, sizeof(magic));
    return std::memcmp(magic, "PK\3\4", sizeof(magic)) == 0;
}

[[noreturn]] void refuse_stream(const std::filesystem::path& path) {
    throw InputError(path.string(), "", "is a stream, and this needs the clip that it was made of", "name that .nvv");
}

}  // namespace

ClipKind kind_of(const std::filesystem::path& path) {
    if (stream::is_stream(path)) return ClipKind::kStream;
    if (is_segmented(path)) return ClipKind::kSegments;
    return is_zip(path) ? ClipKind::kPlenoctree : ClipKind::kNvv;
}

bool has_clip_ending(const std::filesystem::path& path) {
    return std::ranges::any_of(kClipEndings, [&](const char* ending) { return path.extension() == ending; });
}

std::string clip_endings_text() {
    return fmt::format("{}", fmt::join(kClipEndings, ", "));
}

void expect_no_stream(const std::filesystem::path& path) {
    if (kind_of(path) == ClipKind::kStream) refuse_stream(path);
}

VOctree read_clip(const std::filesystem::path& path, PlenoctreeColours colours, UpAxis up) {
    switch (kind_of(path)) {
        case ClipKind::kSegments:
            throw InputError(
                path.string(), "", "is a clip in segments, which this cannot take as a whole",
                fmt::format("name one of its segments, such as {}", (path / segment_file_name(0)).string()));
        case ClipKind::kStream:
            refuse_stream(path);
        case ClipKind::kPlenoctree:
            return read_plenoctree(path, colours, up);
        case ClipKind::kNvv:
            break;
    }
    return read_nvv(path);
}

namespace {

void require_frames(const ClipSegment& segment, uint32_t frames) {
    if (frames != segment.frames_of_file())
        throw InputError(segment.file.string(), "HEAD",
                         fmt::format("has {} frames, clip.json says {}", frames, segment.frames_of_file()),
                         "train the segment again");
}

}  // namespace

namespace {

glm::vec3 vector_of(const std::array<float, 3>& numbers) {
    return {numbers[0], numbers[1], numbers[2]};
}

const stream::Group& group_of(const ClipSegment& segment) {
    const stream::Index& index = segment.stream->index();
    return index.groups[index.group_of(segment.first)];
}

NvvHeader header_of_frame(const ClipSegment& segment) {
    const stream::Group& group = group_of(segment);
    return {group.format.depth / 2,
            0,
            0,
            group.format.most_leaves,
            1,
            group.format.degree,
            1,
            segment.stream->index().fps,
            vector_of(group.box_min),
            vector_of(group.box_size)};
}

}  // namespace

FrameSlice read_slice(const ClipSegment& frame, stream::Part last) {
    const stream::Group& group = group_of(frame);
    return {frame.stream->frame(frame.first, last), vector_of(group.box_min), vector_of(group.box_size)};
}

VOctree read_segment(const ClipSegment& segment, stream::Part last, PlenoctreeColours colours) {
    if (segment.stream) {
        keep_freed_memory();  // a frame has tens of megabytes of arrays, which take as long to clear as to fill
        const FrameSlice frame = read_slice(segment, last);
        const TraceSpan span("make the tree of frame", segment.first);
        return tree_of(slice::values_of(*frame.slice, frame.box_min, frame.box_size), segment.stream->index().fps);
    }
    VOctree tree = read_clip(segment.file, colours, segment.up);
    require_frames(segment, tree.frames);
    return tree;
}

NvvHeader read_segment_header(const ClipSegment& segment) {
    if (segment.stream) return header_of_frame(segment);
    const NvvHeader header = summarise_nvv(segment.file).header;
    require_frames(segment, header.frames);
    return header;
}

namespace {

ClipHeader read_segmented_header(const std::filesystem::path& path) {
    const ClipIndex index = read_clip_index(path);
    std::optional<std::pair<glm::vec3, glm::vec3>> box, empty;  // of the segments with leaves, and of one without
    Note problem;
    for (const ClipSegment& segment : index.segments) {
        try {
            const NvvHeader header = read_segment_header(segment);
            const std::pair one(header.box_min, header.box_min + header.box_size);
            if (header.leaf_count == 0)
                empty = one;
            else
                box = box ? std::pair(glm::min(box->first, one.first), glm::max(box->second, one.second)) : one;
        } catch (const InputError& error) {
            if (problem.empty()) problem = Note(error);
        }
    }
    if (!box) box = empty;
    if (!box) throw InputError(path.string(), "", "none of its segments can be read: " + problem.text, problem.fix);
    return {index.frames(), index.fps, box->first, box->second - box->first};
}

}  // namespace

ClipHeader read_clip_header(const std::filesystem::path& path, UpAxis up) {
    switch (kind_of(path)) {
        case ClipKind::kSegments:
        case ClipKind::kStream:
            return read_segmented_header(path);
        case ClipKind::kPlenoctree: {
            const auto [box_min, box_size] = read_plenoctree_box(path, up);
            return {1, VOctree{}.fps, box_min, box_size};
        }
        case ClipKind::kNvv:
            break;
    }
    const NvvHeader header = summarise_nvv(path).header;
    return {header.frames, header.fps, header.box_min, header.box_size};
}

}  // namespace neuvv::voctree

#include "voctree/files/clip.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>

#include "base/error.h"
#include "stream/transport/nvs_reader.h"
#include "voctree/kinds/clip_source.h"
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

VOctree read_segment(const ClipSegment& segment, PlenoctreeColours colours) {
    SegmentContent content = segment.source->content(segment, stream::kShFine, colours);
    if (auto* tree = std::get_if<VOctree>(&content)) return std::move(*tree);
    return tree_of(slice_at(content, 0), segment.source->header(segment).fps);
}

ClipHeader read_clip_header(const std::filesystem::path& path, UpAxis up) {
    const ClipIndex index = read_clip_index(path, up);
    std::optional<std::pair<glm::vec3, glm::vec3>> box, empty;  // of the segments with leaves, and of one without
    Note problem;
    for (const ClipSegment& segment : index.segments) {
        try {
            const NvvHeader header = segment.source->header(segment);
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

}  // namespace neuvv::voctree

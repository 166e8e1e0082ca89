// Segmented clips: a clip of any length as a folder NAME.nvv, in which each segment is a .nvv of its own with a few
// frames, and clip.json lists the segments in their order. A clip that is one file counts as one segment here.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "voctree/files/plenoctree.h"

namespace neuvv::voctree {

class ClipSource;
std::shared_ptr<const ClipSource> nvv_source();  // of all segments that are .nvv files

// A run of frames of a clip.
struct ClipSegment {
    // With the clip's folder; it may be missing as long as the clip is being trained. Of a stream, a name that no file
    // has: the stream's path and the frame.
    std::filesystem::path file;
    uint32_t first = 0;  // frame of the clip
    uint32_t frames = 1;
    // How many more frames the file has at its end: the first ones of the next segment. Slow motion goes on smoothly to
    // them, and players fade over them from this segment to the next (segment_shares).
    uint32_t overlap = 0;
    std::shared_ptr<const ClipSource> source = nvv_source();  // what it is read from (voctree/kinds/clip_source.h)
    uint32_t end() const { return first + frames; }
    uint32_t frames_of_file() const { return frames + overlap; }
};

// What one frame of a clip takes at most: that of the frames with most coefficients, leaves times harmonics.
struct FrameBound {
    uint64_t leaves = 0;
    uint32_t degree = 0;
};

struct ClipIndex {
    float fps = 25;
    std::vector<ClipSegment> segments;  // at least one; without gaps from frame 0 on
    uint32_t frames() const { return segments.back().end(); }
    std::optional<FrameBound> plays_by_frame() const;  // ClipSource::plays_by_frame of its segments
};

constexpr uint32_t kMaxClipFrames = 10'000'000;  // 46 hours at 60 fps

// The index of a segmented clip: its clip.json.
std::filesystem::path index_file(const std::filesystem::path& clip);

// Whether the path is a folder with a clip.json.
bool is_segmented(const std::filesystem::path& clip);

// A clip's path without a separator at its end, which shells add when they complete the name of a folder.
std::filesystem::path clip_path(const std::filesystem::path& given);

// Reads the index of a clip of any kind; of a clip that is one file, its header is read. Throws InputError with file,
// place and fix for what is damaged or out of bounds, and for a file that is named twice. Segments are not opened, so
// that a clip with a damaged segment can be played but for that segment.
ClipIndex read_clip_index(const std::filesystem::path& clip, UpAxis up = UpAxis::kZ);

// The indices of so many segments, those nearest to the clip's middle first.
std::vector<size_t> segments_from_middle(size_t segments);

// Writes clip.json into an existing folder, atomically. The segments' files must lie in the folder. Throws
// RuntimeFailure.
void write_clip_index(const std::filesystem::path& folder, const ClipIndex& index);

// The file name of a segment, which sorts by frame: "000012.nvv" for the one that begins with frame 12.
std::string segment_file_name(uint32_t first_frame);

// A frame of a clip, 0..frames−1, between frames where it has a fraction, as a place in a segment. Between the last
// frame of a segment and the first of the next, it lies in the first one's overlap; without an overlap it is the nearer
// of the two frames.
struct SegmentFrame {
    uint32_t segment = 0;  // index into ClipIndex::segments
    float frame = 0;       // in that segment's file
};
SegmentFrame segment_frame(const ClipIndex& index, double frame);

// What a player shows at a frame of a clip: a place in the segment of segment_frame, and around an overlap one in the
// other segment, too. From the last frame before an overlap of k frames to the first behind it, the share of the
// earlier segment falls from 1 to 0, by 1 / (k + 1) from frame to frame, so that no cut between two trees is seen.
// Between whole frames, a segment that has no frame at that time yet, or any more, shows its nearest.
struct SegmentShare {
    SegmentFrame at;
    float share = 1;  // of the density; the shares of a frame sum to 1
};
// One or two, the one of segment_frame first.
std::vector<SegmentShare> segment_shares(const ClipIndex& index, double frame);

// The frames over which a segment fades into the next: its overlap, but fewer than the next one has.
uint32_t fade_frames(const ClipIndex& index, size_t segment);

}  // namespace neuvv::voctree

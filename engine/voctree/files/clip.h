// Clips that can be played, of all kinds.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "voctree/files/clip_index.h"
#include "voctree/files/nvv.h"
#include "voctree/files/plenoctree.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

enum class ClipKind {
    kNvv,         // a .nvv
    kSegments,    // a folder of them (clip_index.h)
    kStream,      // a .nvs, or the address of one
    kPlenoctree,  // a .npz, as a clip of one frame
};

// The kind that a file's first bytes tell, or a folder's clip.json. What is of no other kind, or cannot be read, counts
// as a .nvv, whose reader says what is wrong with it.
ClipKind kind_of(const std::filesystem::path& path);

// How files of these kinds end.
inline constexpr std::array kClipEndings{".nvv", ".nvs", ".npz"};
bool has_clip_ending(const std::filesystem::path& path);
// In a text: ".nvv, .nvs, .npz".
std::string clip_endings_text();

// Reads a clip that is one file. Throws InputError where read_nvv or read_plenoctree does, and for a segmented clip
// (clip_index.h) and a stream, whose segments are read one by one.
VOctree read_clip(const std::filesystem::path& path, PlenoctreeColours colours = PlenoctreeColours::kLinear,
                  UpAxis up = UpAxis::kZ);

// The tree of a segment of any clip; of a slice, a tree of one frame. Who draws it on the device takes the colours of a
// PlenOctree as they are stored. Throws as ClipSource::content.
VOctree read_segment(const ClipSegment& segment, PlenoctreeColours colours = PlenoctreeColours::kLinear);
inline VOctree read_shown_segment(const ClipSegment& segment) {
    return read_segment(segment, PlenoctreeColours::kAsStored);
}

struct ClipHeader {
    uint32_t frames;
    float fps;
    glm::vec3 box_min, box_size;  // metres
};

// Reads a clip's header without its leaves. The box of a segmented clip holds the boxes of all of its segments that can
// be read and have leaves. Throws InputError where the file's headers are damaged, or where no segment can be read.
ClipHeader read_clip_header(const std::filesystem::path& path, UpAxis up = UpAxis::kZ);

// Throws InputError where the file is a stream.
void expect_no_stream(const std::filesystem::path& path);

}  // namespace neuvv::voctree

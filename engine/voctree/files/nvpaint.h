// Reads and writes .nvpaint files, each a layer of paint. The byte layout is specified in engine/voctree/README.md.
#pragma once

#include <filesystem>

#include "voctree/edit_layer.h"
#include "voctree/files/clip_index.h"

namespace neuvv::voctree {

// Writes the file atomically. Throws RuntimeFailure where the disk fails or the layer has a defect_of, and then leaves
// the old file as it was.
void write_paint(const std::filesystem::path& path, const EditLayer& layer);

// Throws InputError naming the file, the chunk and the fix. Every number in the file is checked. A layer of another
// field is refused, and so is one of this field whose leaves have changed since.
EditLayer read_paint(const std::filesystem::path& path, const PaintedField& field);

// A layer of paint on a clip in segments is a folder NAME.nvpaint. A segment that has paint has a .nvpaint of its own
// there, with the name of the segment's file: that of 000012.nvv is 000012.nvpaint.
std::filesystem::path paint_file(const std::filesystem::path& layer, const ClipSegment& segment);

// A segment's part of such a layer, without edits where there is no file for the segment. Throws InputError as
// read_paint does.
EditLayer read_segment_paint(const std::filesystem::path& layer, const ClipSegment& segment, const PaintedField& field);
// Writes a file of such a layer atomically, and makes its folder where it is missing; without edits there is no file.
// Throws RuntimeFailure as write_paint does.
void write_segment_paint(const std::filesystem::path& file, const EditLayer& layer);
// Throws InputError where there is no folder at this path.
void expect_paint_folder(const std::filesystem::path& layer);

}  // namespace neuvv::voctree

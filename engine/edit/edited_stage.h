// A stage as it is edited: its file, and layers of paint that are not on the disk yet. History undoes both, one save
// writes both.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "stage/stage_file.h"
#include "voctree/paint.h"

namespace neuvv::edit {

// By paint_path. Layers do not change: who paints puts another one in.
using PaintLayers = std::map<std::filesystem::path, std::shared_ptr<const voctree::EditLayer>>;

struct Document {
    stage::StageFile file;
    // Layers as edited; one that is missing here is as on the disk. Put one in by open_paint before its first edit, so
    // that undo knows how it was; one that has no file yet, at any time.
    PaintLayers paint;
    PaintLayers saved_paint;  // those of them that the disk holds, as it holds them
    // The file on the disk is not what this was made from, but another program's (a recovered document's).
    bool disk_is_foreign = false;
};

// Whether both say and paint the same, wherever they lie and whatever the disk has.
bool same_document(const Document& a, const Document& b);

// The .nvpaint that a layer's uri names, absolute. Throws InputError as file_of_uri.
std::filesystem::path paint_path(const stage::StageFile& file, const std::string& uri);

// The layer as edited, else as read from the disk, which then is in both lists. Throws InputError as read_paint.
std::shared_ptr<const voctree::EditLayer> open_paint(Document& document, const std::filesystem::path& path,
                                                     const voctree::PaintedField& field);

// Writes the layers that the stage's performers wear and the disk does not hold so, then the stage to `path`, which is
// the file's then (save_stage_file): each file atomically. Layers stay where they are; stages that share one share its
// edits. Where another program has written the stage's file since it was read, that version is kept beside it under a
// name that is free, "stage-theirs.gltf", which is returned. Throws InputError for a document that could not be loaded
// again (expect_sound_document), RuntimeFailure where the disk fails; what was written by then stays written.
std::optional<std::filesystem::path> save_document(Document& document, const std::filesystem::path& path);
// The first of "stage.gltf", "stage-2.gltf", … that is not there.
std::filesystem::path free_path(const std::filesystem::path& wanted);
// "saved stage.gltf", and what became of another program's version.
std::string saved_text(const std::filesystem::path& path, const std::optional<std::filesystem::path>& theirs);

}  // namespace neuvv::edit

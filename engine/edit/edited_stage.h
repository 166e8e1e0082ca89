// A stage as it is edited: its file, and the layers of paint that were edited. History undoes both, and one save writes
// both.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "stage/file/stage_file.h"
#include "voctree/edit_layer.h"

namespace neuvv::edit {

using voctree::PaintLayers;

struct Document {
    stage::StageFile file;
    // The layers as edited, by the paths of their files; what is missing here is as on the disk. open_paint adds a file
    // before its first edit, so that undo knows how it was. The files of a new layer may be added at any time.
    PaintLayers paint;
    // Those of `paint` that the disk has, as it has them; also without edits, for a segment that has no file.
    PaintLayers saved_paint;
    // Whether the file on the disk is not the one that this document was made from, but another program's. This is so
    // for a recovered document.
    bool disk_is_foreign = false;
};

// Whether both documents have the same JSON and the same layers, whatever their paths and saved states are.
bool same_document(const Document& a, const Document& b);

// The absolute path of the .nvpaint that a layer's URI names. Throws InputError as file_of_uri.
std::filesystem::path paint_path(const stage::StageFile& file, const std::string& uri);

// The layer as edited. A layer that has not been edited is read from the disk and added to `paint` and `saved_paint`.
// Throws InputError as read_paint.
std::shared_ptr<const voctree::EditLayer> open_paint(Document& document, const std::filesystem::path& path,
                                                     const voctree::PaintedField& field);

// The version of a file that another program had written: it is kept beside the file under a free name like
// "stage-theirs.gltf". Of a layer in segments, both are folders, and the kept one has the segments that were changed.
struct KeptVersion {
    std::filesystem::path of, as;
};

// Writes the layers that performers of the stage use and that differ from the disk, then the stage to `path`, which
// becomes the path of the file (save_stage_file). Each file is written atomically. Layers keep their paths, so stages
// that share a layer share its edits. Where another program has written one of these files since it was read, that
// version is kept; those are returned. Throws InputError for a document that could not be loaded again
// (expect_sound_document), and RuntimeFailure where the disk fails; files that were written by then stay written.
// While another program edits a file (EditLock), `waits_on` is asked each second, with the file, whether to wait on;
// else RuntimeFailure is thrown.
using WaitsOn = std::function<bool(const std::filesystem::path&)>;
std::vector<KeptVersion> save_document(Document& document, const std::filesystem::path& path,
                                       const WaitsOn& waits_on = {});
// The first of "stage.gltf", "stage-2.gltf", … that does not exist.
std::filesystem::path free_path(const std::filesystem::path& preferred);
// The message about a save: "saved stage.gltf", and what became of another program's versions.
std::string saved_text(const std::filesystem::path& path, const std::vector<KeptVersion>& kept);

}  // namespace neuvv::edit

// The layers of paint that performers use, as the document lists them, and how a painted layer gets into the document.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "edit/edited_stage.h"
#include "stage/performer_settings.h"

namespace neuvv::edit {

struct ListedLayer {
    std::filesystem::path path;  // absolute, by paint_path
    stage::PaintLayer entry;
};

// The layers of a performer's node, the lowest first; nullopt where the node is no performer. read.h says what is
// expected of the document.
std::optional<std::vector<ListedLayer>> paint_layers_of(const stage::StageFile& file, uint32_t node);

// The name that people see: the layer's name, else the name of its file.
std::string title_of(const ListedLayer& layer);

// A path for a new .nvpaint beside the stage that neither the disk nor the document has.
std::filesystem::path free_paint_path(const Document& document, uint32_t node);

// The paths of the layers of all performers.
std::set<std::filesystem::path> used_layers(const stage::StageFile& file);
// Whether another performer uses the layer, too.
bool is_shared(const stage::StageFile& file, uint32_t node, const std::filesystem::path& path);
// An operation: replaces the performer's layer at index `at`, which others share, by a layer of its own at `new_path`,
// with the same name, visibility, opacity and blend mode. The new layer has no file yet.
std::string unshare_paint(Document& document, uint32_t node, size_t at, const std::filesystem::path& new_path,
                          std::shared_ptr<const voctree::EditLayer> layer);

// An operation: sets files of the layer at this path (voctree::files_of_layer). Where the performer does not use the
// layer yet, it becomes the performer's uppermost one, with the name `name`. `what` is the returned line about the
// edit.
std::string set_paint(Document& document, uint32_t node, const std::filesystem::path& path, const std::string& name,
                      const PaintLayers& files, const std::string& what);

}  // namespace neuvv::edit

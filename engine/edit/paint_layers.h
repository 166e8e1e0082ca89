// The layers of paint that performers wear, as their document lists them, and how a painted one gets into it.
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
    std::filesystem::path path;  // paint_path
    stage::PaintLayer entry;
};

// The lowest first. Nothing where the node is no performer. What is expected of the document: read.h.
std::optional<std::vector<ListedLayer>> paint_layers_of(const stage::StageFile& file, uint32_t node);

// What people call it: its name, else its file's.
std::string title_of(const ListedLayer& layer);

// A .nvpaint beside the stage that neither the disk nor the document has.
std::filesystem::path free_paint_path(const Document& document, uint32_t node);

// Of all performers.
std::set<std::filesystem::path> used_layers(const stage::StageFile& file);
// Whether another performer wears it, too.
bool is_shared(const stage::StageFile& file, uint32_t node, const std::filesystem::path& path);
// The performer wears `own`, which has no file yet, in the place of its `at`-th layer, as it was. An operation.
std::string unshare_paint(Document& document, uint32_t node, size_t at, const std::filesystem::path& own,
                          std::shared_ptr<const voctree::EditLayer> layer);

// The layer becomes this; one that the performer does not wear yet becomes its uppermost, called `name`. An operation.
std::string set_paint(Document& document, uint32_t node, const std::filesystem::path& path, const std::string& name,
                      std::shared_ptr<const voctree::EditLayer> layer, const std::string& what);

}  // namespace neuvv::edit

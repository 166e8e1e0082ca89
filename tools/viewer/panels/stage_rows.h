// The tree of a stage as rows: what the stage panel shows of each node.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "edit/read.h"

namespace neuvv::viewer {

using edit::NodeKind;

struct StageRow {
    uint32_t node = 0;  // of the document
    uint32_t depth = 0;
    uint32_t below = 0;  // so many of the next rows hang on it
    NodeKind kind = NodeKind::kGroup;
    std::string title;  // its name, or "node 3"
    bool shown = true;  // as it says itself
    bool ancestors_visible = true;
    bool locked = false;  // itself
};

// The nodes of the scene that is shown, parents before what hangs on them. The document is sound.
std::vector<StageRow> stage_rows(const stage::StageFile& file);

// The rows, by index, that are seen where these are closed, by title.
std::vector<uint32_t> listed_rows(const std::vector<StageRow>& rows, const std::set<std::string>& closed);

// The index of a node's row; nothing where the scene does not hold it.
std::optional<uint32_t> row_of(const std::vector<StageRow>& rows, uint32_t node);

// Opens all above a row.
void open_ancestors(const std::vector<StageRow>& rows, uint32_t row, std::set<std::string>& closed);

// The title of what keeps a row's node from being removed: itself, or the first below it, where that is locked.
std::optional<std::string> locked_within(const std::vector<StageRow>& rows, uint32_t row);

}  // namespace neuvv::viewer

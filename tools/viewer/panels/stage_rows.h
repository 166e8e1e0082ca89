// The tree of a stage as rows: what the stage panel displays of each node.
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
    uint32_t descendants = 0;  // so many of the next rows are its descendants
    NodeKind kind = NodeKind::kGroup;
    std::string title;              // its name, or "node 3"
    bool visible = true;            // not hidden itself
    bool ancestors_visible = true;  // no ancestor is hidden
    bool locked = false;            // locked itself
    bool has_sound = false;         // a performer's
};

// The nodes of the default scene, each before its descendants. The document must be sound.
std::vector<StageRow> stage_rows(const stage::StageFile& file);

// The indices of the rows that are listed where the rows with these titles are closed.
std::vector<uint32_t> listed_rows(const std::vector<StageRow>& rows, const std::set<std::string>& closed);

// The index of a node's row; nullopt where the scene does not contain the node.
std::optional<uint32_t> row_of(const std::vector<StageRow>& rows, uint32_t node);

// Opens all ancestors of a row.
void open_ancestors(const std::vector<StageRow>& rows, uint32_t row, std::set<std::string>& closed);

// The title of the first locked node among a row's node and its descendants, which keeps the node from being removed;
// nullopt: none is locked.
std::optional<std::string> locked_within(const std::vector<StageRow>& rows, uint32_t row);

}  // namespace neuvv::viewer

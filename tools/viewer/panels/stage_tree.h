// The tree of nodes as the stage panel displays it, and what its menus, its buttons and keys do to a node.
#pragma once

#include <set>

#include "edit/operations.h"
#include "tools/viewer/context.h"
#include "tools/viewer/panels/stage_rows.h"

namespace neuvv::viewer {

// What is asked before a node is duplicated.
struct CopyQuestion {
    bool ask = false;
    uint32_t node = 0;
    uint64_t id = 0;  // of the document
    edit::CopySettings settings{3, edit::CopyPattern::kRow, 1.5, 90, {0, true}, 0};
};

struct StageTree {
    uint64_t id = 0;  // of the document that the rows are of
    std::vector<StageRow> rows;
    std::set<std::string> closed;               // titles of rows whose descendants are not listed
    std::optional<uint32_t> renaming;           // the node whose name is typed
    std::string typed;                          // so far
    bool begin_typing = false;                  // in this frame
    std::optional<uint32_t> scrolled_selected;  // the selected node that the tree was scrolled to
    CopyQuestion copies;
};

// Makes the rows those of the document, where it has changed since. Panels that use them call it first.
void follow_document(const Context& context, StageTree& tree);

// The tree has a field for the node's name from now on.
void begin_renaming(StageTree& tree, uint32_t node);
// Adds a copy at the same position, and selects it.
void duplicate_once(Context& context, uint32_t node);
// Removes the node and its descendants; refuses with a notice where one of them is locked.
void delete_node(Context& context, const StageTree& tree, uint32_t node);
// Adds a light that shines on what the eye looks at, and selects it.
void add_light_in_view(Context& context, stage::GltfLightKind kind);
// Adds a camera that sees what the eye sees, and selects it.
void add_camera_in_view(Context& context);

// H, F2, Ctrl-D and Del, for the selected node. No text may be typed meanwhile.
void handle_node_keys(Context& context, StageTree& tree);

// Many copies: asks how many, where, and how much later each begins.
void ask_duplicate(const Context& context, CopyQuestion& question, uint32_t node);
void duplicate_dialog(Context& context, StageTree& tree);  // each frame

}  // namespace neuvv::viewer

// The state of the tree of nodes in the stage panel, and the edits of nodes that menus, buttons and keys make.
#pragma once

#include <set>

#include "edit/operations.h"
#include "tools/viewer/context.h"
#include "tools/viewer/panels/stage_rows.h"

namespace neuvv::viewer {

// The dialog that asks how a node is to be duplicated.
struct CopyQuestion {
    bool ask = false;  // it is to be opened
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
    bool begin_typing = false;                  // the field gets the keyboard in the next frame
    std::optional<uint32_t> scrolled_selected;  // the selected node that the tree was scrolled to
    CopyQuestion copies;
};

// Reads the rows again where the document has changed. Panels call it before they use the rows.
void follow_document(const Context& context, StageTree& tree);

// Displays a text field for the node's name in the tree.
void begin_renaming(StageTree& tree, uint32_t node);
// Adds a copy at the same position, and selects it.
void duplicate_once(Context& context, uint32_t node);
// Removes the node and its descendants; refuses with a notice where one of them is locked.
void delete_node(Context& context, const StageTree& tree, uint32_t node);
// Adds a light that shines on what the eye looks at, and selects it.
void add_light_in_view(Context& context, stage::GltfLightKind kind);
// Adds a camera that sees what the eye sees, and selects it.
void add_camera_in_view(Context& context);

// Handles H, F2, Ctrl+D and Del for the selected node. Not to be called while text is typed.
void handle_node_keys(Context& context, StageTree& tree);

// Opens the dialog that asks how many copies to make, where they stand, and how much later each begins.
void ask_duplicate(const Context& context, CopyQuestion& question, uint32_t node);
void duplicate_dialog(Context& context, StageTree& tree);  // each frame

}  // namespace neuvv::viewer

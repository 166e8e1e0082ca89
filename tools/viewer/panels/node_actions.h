// What is done to nodes from the tree, its menus, and keys: the same for each.
#pragma once

#include "stage/gltf_scene.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

// Makes the tree's rows those of the document, where it has changed since. Panels that use them call it first.
void follow_document(Viewer& viewer);

// Begins to type its name in the tree.
void begin_renaming(Viewer& viewer, uint32_t node);
// A copy beside it, which is selected.
void duplicate_once(Viewer& viewer, uint32_t node);
// The node and what hangs on it; refused with a notice where any of it is locked.
void delete_node(Viewer& viewer, uint32_t node);
// Shines on what is looked at; selected.
void add_light_in_view(Viewer& viewer, stage::GltfLightKind kind);
// Sees what is seen now; selected.
void add_camera_in_view(Viewer& viewer);

// F2, Ctrl-D and Del, while no other panel has the keys.
void take_node_keys(Viewer& viewer);

// Many copies: asks how many, where and how much later.
void ask_duplicate(Viewer& viewer, uint32_t node);
void duplicate_dialog(Viewer& viewer);  // each frame

}  // namespace neuvv::viewer

// The slice tree of a decoded frame as C functions, for browsers: what their renderer puts into textures.
#pragma once

#include "stream/codec/group_decoder.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct NeuvvSliceTree NeuvvSliceTree;

typedef struct {
    uint32_t nodes;    // four words each
    uint32_t entries;  // 2 · (degree + 1)² words each
    uint32_t links;    // one word each
    uint32_t node_levels, top_levels;
    uint32_t top_first, top_last;  // TopBox
    uint32_t scale;                // of the box in which the tree lies: 1, or 2 where its root is one level higher
} NeuvvSliceTreeShape;

// Of the group's last frame, in a box of this size, metres. Null where there is no frame, or no memory. To be freed by
// neuvv_slice_tree_free.
NeuvvSliceTree* neuvv_slice_tree_new(const NeuvvGroupDecoder* group, float size_x, float size_y, float size_z);
void neuvv_slice_tree_free(NeuvvSliceTree* tree);

const NeuvvSliceTreeShape* neuvv_slice_tree_shape(const NeuvvSliceTree* tree);
// The words, as shared/slice_tree.h and shared/tree.h have them.
const uint32_t* neuvv_slice_tree_nodes(const NeuvvSliceTree* tree);
const uint32_t* neuvv_slice_tree_entries(const NeuvvSliceTree* tree);
const uint32_t* neuvv_slice_tree_links(const NeuvvSliceTree* tree);

#ifdef __cplusplus
}
#endif

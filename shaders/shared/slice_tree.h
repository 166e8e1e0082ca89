// The slice tree: a slice for playing. Its nodes are those of the walk tree, pruned to live cells, and its entries have
// σ and colour where a walk finds them.
//
// A node is four words: mask_lo and mask_hi of its live cells, the index of its first entry, and its wide octants; a
// node without live leaves has no cells. Each live cell (each wide octant) has an entry. The entry of a leaf has σ and
// SH coefficients as fp16, kEntryWords words for each SH function:
//   word 0: σ (1/m) | R << 16, word 1: G | B << 16;  σ is 0 in the words after those of the first function.
// A shaded entry has the words of one function alone, with the leaf's colour in place of coefficients. The entry of a
// child node has the sign of σ set, and the node's index in word 1.
//
// Several slices lie behind each other in the same buffers, each with room for the same number of nodes and entries. A
// node's index is relative to its slice's first node (node_base); an entry's index is relative to the first entry of
// the buffer. Shaded entries are stored for one slice, view after view, so that their index is relative to the slice's
// first entry (entry_base) and offset by the view's (shaded_stride).
#ifndef NEUVV_SHARED_SLICE_TREE_H
#define NEUVV_SHARED_SLICE_TREE_H
#include "shared/slice.h"
#include "shared/trace.h"

NEUVV_SHARED

CONSTEXPR uint kEntryWords = 2u;
CONSTEXPR uint kEntryIsNode = 0x8000u;       // in word 0
CONSTEXPR uint kNoLeaf = 0xffffffffu;        // of a child node's entry
CONSTEXPR float kMaxEntryNumber = 65504.0f;  // the largest fp16 number

// slice_nodes.comp
CONSTEXPR uint kNodesTree = 0u;
CONSTEXPR uint kNodesLinks = 1u;  // as Field::links
CONSTEXPR uint kNodesCells = 2u;  // as Field::node_cells: its words are those of kNodesLive
CONSTEXPR uint kNodesLive = 4u;   // per node: mask of live cells, which is complete where finer levels have run
CONSTEXPR uint kNodesOut = 5u;
CONSTEXPR uint kNodesEntries = 6u;
CONSTEXPR uint kNodesLeaves = 7u;  // per entry: its leaf, or kNoLeaf
CONSTEXPR uint kNodesCount = 8u;   // per slice: a LiveCount of entries

struct SliceNodesPush {
    uint first_node;  // of the level
    uint nodes;       // number of nodes of the level
    uint slice;
    uint capacity;    // number of entries for which a slice has room
    uint node_base;   // the slice's first node
    uint tree_nodes;  // number of nodes of all levels
};

// slice_entries.comp: the bindings of slice_colour.comp except kSliceSh, and
CONSTEXPR uint kEntriesCells = 6u;  // as kSliceLeafCells
CONSTEXPR uint kEntriesNodes = 7u;
CONSTEXPR uint kEntriesOut = 8u;
CONSTEXPR uint kEntriesLeaves = 9u;

struct SliceEntriesPush {
    uint leaf_count;
    uint capacity;  // number of slots for live leaves
    uint node_base;
    uint first_slot;
};

// shade.comp
CONSTEXPR uint kShadeEntries = 0u;
CONSTEXPR uint kShadeLeaves = 1u;
CONSTEXPR uint kShadePositions = 2u;  // per leaf: as Field::leaf_positions
CONSTEXPR uint kShadeCount = 3u;      // as kNodesCount
CONSTEXPR uint kShadeOut = 4u;

struct ShadePush {
    vec4 eye;       // performer's space, metres
    vec4 box_min;   // metres
    vec4 box_size;  // metres
    uint slice;
    uint capacity;  // number of entries for which a slice has room
    uint view;
};

// tile_range.comp and tile_list.comp. The tiles of several views are stored behind each other.
CONSTEXPR uint kRangeNodes = 0u;      // of a slice tree or of the whole tree: their first two words
CONSTEXPR uint kRangeCells = 1u;      // as Field::node_cells
CONSTEXPR uint kRangePositions = 2u;  // per node: as Field::node_positions
CONSTEXPR uint kRangeViews = 3u;      // a RangeView each
CONSTEXPR uint kRangeTiles = 4u;  // per tile: bits of the smallest distance, and the complement of those of the largest
CONSTEXPR uint kRangeList = 5u;   // tiles of rays that the instance may cover, then kNoTile
CONSTEXPR uint kRangeCount = 6u;  // a LiveCount of the list
CONSTEXPR uint kRangeCovered = 7u;  // per tile of rays: whether any instance of the frame may cover it
CONSTEXPR uint kRangeSharing = 8u;  // per tile of rays: how many instances of a group may cover it

CONSTEXPR uint kListRow = 32768u;  // workgroups in a row of the dispatch over the list

// The projection of a camera, in its performer's space: (row_x, row_y, row_z) · (p − eye) = z (x, y, 1) for a point p
// and its pixel x, y; the positions of rays among the pixels.
struct RangeView {
    vec4 eye;  // metres; w: the largest distance, in metres, from the eye to a point of the image plane at z = 1
    vec4 row_x;
    vec4 row_y;
    vec4 row_z;
    GridAxis across;
    GridAxis downwards;
};

struct TileRangePush {
    vec4 box_min;     // metres
    vec4 box_size;    // metres
    uint nodes;       // nodes of all levels down to the finest one that is projected
    uint whole_from;  // the first node of that level, whose cells stand for the finer nodes in them
    uint node_base;
    uint first_view;
    uint views;
    uint tiles_across;  // tiles of a view's rays
    uint tiles_down;
    uint counted;  // tile_list.comp: 1 counts the instance in kRangeSharing
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::SliceNodesPush) == 24);
static_assert(sizeof(neuvv::SliceEntriesPush) == 16);
static_assert(sizeof(neuvv::ShadePush) == 60);
static_assert(sizeof(neuvv::RangeView) == 128);
static_assert(sizeof(neuvv::TileRangePush) == 64);
#endif
#endif

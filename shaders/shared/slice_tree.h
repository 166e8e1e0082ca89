// A slice as a tree of its own, for playing: nodes pruned to live cells, and σ and colour of a cell where the walk
// finds it.
//
// A node is four words: mask_lo, mask_hi of its live cells, the entry of the lowest, its wide octants; a dead node has
// no cell. Each cell (each wide octant) has an entry. A leaf's holds its σ and SH coefficients as fp16, kEntryWords
// words for each SH function; shaded, it is the first of these alone, with the colour in place of the coefficients:
//   word 0: σ (1/m) | R << 16, word 1: G | B << 16;  of the functions after the first σ is 0.
// That of a child node has the sign of σ set, and the node in word 1.
//
// Several slices lie behind each other in the same buffers, each with room for as many nodes and entries. Nodes count
// from their slice's first (node_base), entries from the first of all, shaded ones from their slice's first
// (entry_base), those of each view behind those of the view before.
#ifndef NEUVV_SHARED_SLICE_TREE_H
#define NEUVV_SHARED_SLICE_TREE_H
#include "shared/slice.h"
#include "shared/trace.h"

NEUVV_SHARED

CONSTEXPR uint kEntryWords = 2u;
CONSTEXPR uint kEntryIsNode = 0x8000u;       // in word 0
CONSTEXPR uint kNoLeaf = 0xffffffffu;        // of a child node's entry
CONSTEXPR float kMaxEntryNumber = 65504.0f;  // what fp16 holds

// slice_nodes.comp
CONSTEXPR uint kNodesTree = 0u;
CONSTEXPR uint kNodesChildren = 1u;
CONSTEXPR uint kNodesInner = 2u;   // per node: mask of the cells that are nodes
CONSTEXPR uint kNodesParent = 3u;  // per node: (word of kNodesLive, its bit there)
CONSTEXPR uint kNodesLive = 4u;    // per node: mask of live cells, those of finer nodes complete
CONSTEXPR uint kNodesOut = 5u;
CONSTEXPR uint kNodesEntries = 6u;
CONSTEXPR uint kNodesLeaves = 7u;  // per entry: its leaf, or kNoLeaf
CONSTEXPR uint kNodesCount = 8u;   // per slice: a LiveCount of entries

struct SliceNodesPush {
    uint first_node;  // of the level
    uint nodes;
    uint slice;
    uint capacity;   // entries of a slice
    uint node_base;  // of the slice
};

// slice_entries.comp: the bindings of slice_colour.comp but for kSliceSh, and
CONSTEXPR uint kEntriesCells = 6u;  // as kSliceLeafCells
CONSTEXPR uint kEntriesNodes = 7u;
CONSTEXPR uint kEntriesOut = 8u;
CONSTEXPR uint kEntriesLeaves = 9u;

struct SliceEntriesPush {
    uint leaf_count;
    uint capacity;  // slots of live leaves
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
    vec4 eye;       // world, metres
    vec4 box_min;   // metres
    vec4 box_size;  // metres
    uint slice;
    uint capacity;  // entries of a slice
    uint view;
};

// tile_range.comp and tile_list.comp. Tiles of several views stand behind each other.
CONSTEXPR uint kRangeNodes = 0u;  // of a slice tree or of the whole tree: their first two words
CONSTEXPR uint kRangeInner = 1u;
CONSTEXPR uint kRangePositions = 2u;  // per node: as Field::node_positions
CONSTEXPR uint kRangeViews = 3u;      // a RangeView each
CONSTEXPR uint kRangeTiles = 4u;    // per tile: bits of the least distance, and the complement of those of the largest
CONSTEXPR uint kRangeList = 5u;     // tiles of rays where the instance may be seen, then kNoTile
CONSTEXPR uint kRangeCount = 6u;    // a LiveCount of them
CONSTEXPR uint kRangeSharing = 9u;  // per tile of rays: how many instances of a group may be seen there
CONSTEXPR uint kRangeCovered = 7u;  // per tile of rays: whether any instance of the frame may be seen there
CONSTEXPR uint kRangeCameras = 8u;  // as kTraceCameras: where rays stand is as the first `views` of them say

CONSTEXPR uint kListRow = 32768u;  // workgroups a row of the dispatch over the list

// A camera as places go to pixels, in its performer's space: (row_x, row_y, row_z) · (p − eye) = z (x, y, 1) for the
// pixel x, y that sees p. Four texels.
struct RangeView {
    vec4 eye;  // metres; w: the image's farthest place of z = 1 is so many metres away
    vec4 row_x;
    vec4 row_y;
    vec4 row_z;
};

struct TileRangePush {
    vec4 box_min;     // metres
    vec4 box_size;    // metres
    uint nodes;       // those of the coarser levels, and of one more
    uint whole_from;  // the first of this one: finer nodes count as cells of it
    uint node_base;
    uint first_view;
    uint views;
    uint tiles_across;  // of a view's rays
    uint tiles_down;
    uint counted;  // tile_list.comp: 1 adds the instance to kRangeSharing
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::SliceNodesPush) == 20);
static_assert(sizeof(neuvv::SliceEntriesPush) == 16);
static_assert(sizeof(neuvv::ShadePush) == 60);
static_assert(sizeof(neuvv::RangeView) == 64);
static_assert(sizeof(neuvv::TileRangePush) == 64);
#endif
#endif

// Paint over a slice (errata 14): edits of leaves in layers, as the device has them.
//
// Leaves that have edits stand in order, each with the number of its first edit; the edits of a leaf are those of the
// lowest layer first. An edit is one texel of four words and one of one:
//   first and last frame (float bits), R | G << 16, B | alpha << 16 (fp16);   σ (fp16, below 0: stays) | layer << 16.
#ifndef NEUVV_SHARED_PAINT_H
#define NEUVV_SHARED_PAINT_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR float kMaxPaintSigma = 65504.0f;  // 1/m: what fp16 holds
CONSTEXPR uint kPaintLayerLimit = 256u;     // of one paint

// How a layer's colours go over what is below (paint.glsl)
CONSTEXPR uint kPaintNormal = 0u;
CONSTEXPR uint kPaintMultiply = 1u;
CONSTEXPR uint kPaintTint = 2u;
CONSTEXPR uint kPaintRecolour = 3u;

// Colours come from and go to logits that a display still tells from black and white.
CONSTEXPR float kPaintBlack = 1.0f / 4096.0f;

// paint_density.comp
CONSTEXPR uint kPaintLeaves = 0u;  // per painted leaf (leaf, its first edit); at the end (0, all edits)
CONSTEXPR uint kPaintEdits = 1u;
CONSTEXPR uint kPaintSigmas = 2u;
CONSTEXPR uint kPaintLayers = 3u;    // per layer (blend, opacity's bits)
CONSTEXPR uint kPaintHead = 4u;      // as kSliceHead
CONSTEXPR uint kPaintSlots = 5u;     // as kSliceLeaves
CONSTEXPR uint kPaintLive = 6u;      // as kSliceLive
CONSTEXPR uint kPaintCells = 7u;     // as kSliceLeafCells
CONSTEXPR uint kPaintNodeLive = 8u;  // as kSliceNodeLive
// paint_colour.comp: the first four, kPaintCells, and
CONSTEXPR uint kPaintNodes = 9u;     // as kEntriesNodes
CONSTEXPR uint kPaintEntries = 10u;  // read and written

struct PaintPush {
    float frame;
    uint leaves;     // that have edits
    uint capacity;   // slots of live leaves
    uint node_base;  // of the slice
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::PaintPush) == 16);
#endif
#endif

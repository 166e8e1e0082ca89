// Paint over a slice (errata 14): layers of edits of leaves in device memory.
//
// Leaves that have edits are listed in order, each with the index of its first edit; the edits of a leaf begin with
// those of the lowest layer. An edit has a texel of four words and a texel of one word:
//   first and last frame (float bits), R | G << 16, B | alpha << 16 (fp16);   σ (fp16, below 0: stays) | layer << 16.
#ifndef NEUVV_SHARED_PAINT_H
#define NEUVV_SHARED_PAINT_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR float kMaxPaintSigma = 65504.0f;  // 1/m: the largest fp16 number
CONSTEXPR uint kPaintLayerLimit = 256u;     // layers over one slice

// How a layer's colours are blended with those below (paint.glsl)
CONSTEXPR uint kPaintNormal = 0u;
CONSTEXPR uint kPaintMultiply = 1u;
CONSTEXPR uint kPaintTint = 2u;
CONSTEXPR uint kPaintRecolour = 3u;

// Painted colours are clamped to [kPaintBlack, 1 − kPaintBlack], so that their logits are finite.
CONSTEXPR float kPaintBlack = 1.0f / 4096.0f;

// paint_density.comp
CONSTEXPR uint kPaintLeaves = 0u;  // per painted leaf (leaf, its first edit); at the end (0, number of edits)
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
    uint leaves;     // number of leaves that have edits
    uint capacity;   // number of slots for live leaves
    uint node_base;  // the slice's first node
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::PaintPush) == 16);
#endif
#endif

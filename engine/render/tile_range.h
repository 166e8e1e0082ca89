// Tile ranges: which tiles of a picture see a slice tree at all, and between which distances.
#pragma once

#include "render/slice_tree.h"
#include "render/trace.h"

namespace neuvv {

struct TileRanges {
    TileRanges(const Device& device, uint32_t tiles);

    Buffer ranges;                       // per tile (bits of the least distance, complement of those of the largest)
    Buffer list;                         // tiles of rays where the picture sees anything, then kNoTile
    Buffer count;                        // LiveCount of these
    Buffer picture_list, picture_count;  // the same in tiles of the picture
};

class TileRanger {
  public:
    TileRanger(const Device& device, const Field& field, const SliceTrees& trees, const TileRanges& ranges);

  private:
    friend void record_tile_ranges(Commands& commands, const TileRanger& ranger, uint32_t slice,
                                   const ShaderCamera& camera);
    const Field& field_;
    const SliceTrees& trees_;
    const TileRanges& ranges_;
    ComputePass range_, list_;
    BindingSet range_set_, list_set_;
};

// `camera` is that of the tiles, which cover its picture row by row (tiles_of_picture).
void record_tile_ranges(Commands& commands, const TileRanger& ranger, uint32_t slice, const ShaderCamera& camera);

}  // namespace neuvv

// Picture list: the tiles of the pictures that rays with an instance before them add to.
#pragma once

#include "render/tile_range.h"

namespace neuvv {

class PictureLister {
  public:
    PictureLister(const Device& device, const RayBatch& rays, const TileRanges& ranges);

  private:
    friend void record_picture_list(Commands& commands, const PictureLister& lister, const ViewLayout& layout);
    const TileRanges& ranges_;
    ComputePass pass_;
    BindingSet set_;
};

// After a frame's last instance: which tiles of the pictures are to be resolved or upscaled.
void record_picture_list(Commands& commands, const PictureLister& lister, const ViewLayout& layout);

}  // namespace neuvv

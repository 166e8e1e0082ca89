// Picture list: the tiles of the pictures that rays with an instance before them add to.
#pragma once

#include "render/tile_range.h"

namespace neuvv::render {

class PictureLister {
  public:
    PictureLister(const gpu::Device& device, const RayBatch& rays, const TileRanges& ranges);

  private:
    friend void record_picture_list(gpu::Commands& commands, const PictureLister& lister, const ViewLayout& layout);
    const TileRanges& ranges_;
    gpu::ComputePass pass_;
    gpu::BindingSet set_;
};

// After a frame's last instance: which tiles of the pictures are to be resolved or upscaled.
void record_picture_list(gpu::Commands& commands, const PictureLister& lister, const ViewLayout& layout);

}  // namespace neuvv::render

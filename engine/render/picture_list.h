// Picture list: the tiles of the pictures that rays with an instance before them add to.
#pragma once

#include "render/tile_range.h"

namespace neuvv::render {

struct PictureLister {
    PictureLister(const gpu::Device& device, const RayBatch& rays, const TileRanges& ranges);

    const TileRanges& ranges;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// After a frame's last instance: which tiles of the pictures are to be resolved or upscaled.
void record_picture_list(gpu::Commands& commands, const PictureLister& lister, const ViewLayout& layout);

}  // namespace neuvv::render

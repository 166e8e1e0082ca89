// LabImage list: the tiles of the images that rays with an instance before them add to.
#pragma once

#include "render/tile_range.h"

namespace neuvv::render {

struct ImageLister {
    ImageLister(const gpu::Device& device, const RayBatch& rays, const TileRanges& ranges);

    const TileRanges& ranges;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Lists the tiles of the images that are to be resolved or upscaled, in TileRanges::image_list and image_count. To be
// recorded after the last instance of a frame.
void record_image_list(gpu::Commands& commands, const ImageLister& lister, const ViewLayout& layout);

}  // namespace neuvv::render

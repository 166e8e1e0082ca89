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

// After a frame's last instance: which tiles of the images are to be resolved or upscaled.
void record_image_list(gpu::Commands& commands, const ImageLister& lister, const ViewLayout& layout);

}  // namespace neuvv::render

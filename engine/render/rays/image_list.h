// Image list: the tiles of the images that rays with an instance before them add to, or did in the last frame.
#pragma once

#include "render/rays/tile_ranges.h"
#include "render/rays/view_layout.h"

namespace neuvv::render {

struct ImageLister {
    ImageLister(const gpu::Device& device, const RayBatch& rays, const TileRanges& ranges);

    const TileRanges& ranges;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Lists the tiles of the images that are to be resolved or upscaled, in TileRanges::image_list and image_count, and
// marks in image_shown those to which rays with an instance before them add. To be recorded once a frame, after its
// last instance.
void record_image_list(gpu::Commands& commands, const ImageLister& lister, const ViewLayout& layout);

}  // namespace neuvv::render

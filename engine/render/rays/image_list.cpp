#include "render/rays/image_list.h"

#include "shared/image_list.h"
#include "shared/resolve.h"
#include "spirv/image_list.comp.h"

namespace neuvv::render {

ImageLister::ImageLister(const gpu::Device& device, const RayBatch& rays, const TileRanges& given_ranges)
    : ranges(given_ranges),
      pass(device, "image list", image_list_comp),
      set(pass, {{kListCovered, &ranges.covered},
                 {kListCameras, &rays.cameras},
                 {kListImages, &ranges.image_list},
                 {kListShown, &ranges.image_shown},
                 {kListCount, &ranges.image_count}}) {}

void record_image_list(gpu::Commands& commands, const ImageLister& lister, const ViewLayout& layout) {
    const gpu::PassScope scope(commands, "image list");
    record_empty_list(commands, lister.ranges.image_list, lister.ranges.image_count, layout.image_tiles());
    const ImageListPush push{layout.views,
                             layout.tiles_across(),
                             layout.tiles_down(),
                             layout.images_across(),
                             layout.images_down(),
                             layout.samples,
                             layout.upscaled() ? kUpscaleRadius : 0};
    gpu::dispatch(commands, lister.pass, lister.set, layout.image_tiles(), push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render

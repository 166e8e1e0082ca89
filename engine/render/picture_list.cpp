#include "render/picture_list.h"

#include "shared/picture_list.h"
#include "shared/resolve.h"
#include "spirv/picture_list.comp.h"

namespace neuvv::render {

PictureLister::PictureLister(const gpu::Device& device, const RayBatch& rays, const TileRanges& given_ranges)
    : ranges(given_ranges),
      pass(device, "picture list", picture_list_comp),
      set(pass, {{kListSeen, &ranges.seen},
                 {kListCameras, &rays.cameras},
                 {kListPictures, &ranges.picture_list},
                 {kListCount, &ranges.picture_count}}) {}

void record_picture_list(gpu::Commands& commands, const PictureLister& lister, const ViewLayout& layout) {
    const gpu::PassScope scope(commands, "picture list");
    const PictureListPush push{layout.views,
                               layout.tiles_across(),
                               layout.tiles_down(),
                               layout.pictures_across(),
                               layout.pictures_down(),
                               layout.samples,
                               layout.upscaled() ? kUpscaleReach : 0};
    gpu::dispatch(commands, lister.pass, lister.set, layout.picture_tiles(), push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render

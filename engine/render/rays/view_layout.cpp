#include "render/rays/view_layout.h"

#include <fmt/format.h>

#include "base/error.h"

namespace neuvv::render {

uint32_t checked_ray_tiles(const gpu::Device& device, const ViewLayout& layout) {
    const uint64_t across = (uint64_t{layout.samples} * layout.width + kTile - 1) / kTile;
    const uint64_t down = (uint64_t{layout.samples} * layout.height + kTile - 1) / kTile;
    const uint64_t tiles = across * down * layout.views;
    if (tiles * kTilePixels > device.buffers().max_elements(16) || tiles > device.buffers().texels)
        throw RuntimeFailure(fmt::format("{}x{} pixels of {} rays are too many for this device", layout.width,
                                         layout.height, layout.samples * layout.samples),
                             Remedy::kSmallerImageOrFewerRays);
    return static_cast<uint32_t>(tiles);
}

}  // namespace neuvv::render

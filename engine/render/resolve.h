// Resolve: traced rays to an 8-bit sRGB image, one or several of them a pixel, or fewer than pixels (upscale).
#pragma once

#include "gpu/commands.h"
#include "render/image_list.h"
#include "render/set_raster.h"
#include "shared/resolve.h"

namespace neuvv::render {

enum class Show : uint32_t {
    kColour = kShowColour,
    kAlpha = kShowAlpha,
    kDepth = kShowDepth,
    kLevel = kShowLevel,  // inspect.h: how deep in the octree the leaf lies at which a ray meets a surface
    kCost = kShowCost,    // and how many steps its walk took
};
// Whether rays are to be traced Into::kInspect, and shown by record_inspect.
constexpr bool is_inspection(Show show) {
    return show == Show::kLevel || show == Show::kCost;
}

struct ResolveSettings {
    Show show = Show::kColour;
    glm::vec4 background{0};  // linear RGB, opacity (0: the image keeps its alpha)
    float depth_near_m = 0, depth_far_m = 1;
    float cost_max = 256;  // steps that are shown brightest
    bool operator==(const ResolveSettings&) const = default;
};

// How many rays there are.
enum class RaysPerPixel { kWhole, kFewer };

struct Resolver {
    // `image`: at least views·width·height R32_UINT texels. `only`: the tiles that see anything; the others stay.
    // `set`: behind and before the rays.
    Resolver(const gpu::Device& device, RaysPerPixel rays_per_pixel, const RayBatch& rays, const gpu::Buffer& image,
             const TileRanges* listed = nullptr, const SetRaster* set = nullptr);

    const TileRanges* listed;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Whole: the rays of each view must be tiles_of_image(·, samples·width, samples·height); a pixel is the mean of
// samples² of them. Fewer: where they stand is as the batch's first cameras say, one a view. No inspection.
void record_resolve(gpu::Commands& commands, const Resolver& resolver, const ViewLayout& layout,
                    const ResolveSettings& settings);

}  // namespace neuvv::render

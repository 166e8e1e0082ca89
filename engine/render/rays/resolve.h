// Resolve: makes an 8-bit sRGB image of traced rays, of which there are one or several per pixel, or fewer than pixels
// (upscale).
#pragma once

#include "gpu/commands.h"
#include "render/rays/image_list.h"
#include "render/set/set_targets.h"
#include "shared/resolve.h"

namespace neuvv::render {

// What an image shows.
enum class Show : uint32_t {
    kColour = kShowColour,
    kAlpha = kShowAlpha,
    kDepth = kShowDepth,
    kLevel = kShowLevel,  // inspect.h: the depth in the octree of the leaf where a ray meets a surface
    kCost = kShowCost,    // inspect.h: the number of steps of a ray's walks
};
// Whether rays must be traced as RayOutput::kInspect, and the image be made by record_inspect.
constexpr bool is_inspection(Show show) {
    return show == Show::kLevel || show == Show::kCost;
}

struct ResolveSettings {
    Show show = Show::kColour;
    glm::vec4 background{0};                  // linear RGB and opacity (0: the image keeps its alpha)
    float depth_near_m = 0, depth_far_m = 1;  // kDepth: shown white and black
    float cost_max = 256;                     // kCost: the number of steps that is shown brightest
    bool operator==(const ResolveSettings&) const = default;
};

// Whether there are one or several rays per pixel, or fewer than one.
enum class RaysPerPixel { kWhole, kFewer };

struct Resolver {
    // `image` has at least views·width·height R32_UINT texels. `listed`, if not null: only the tiles of its image_list
    // are resolved, and the other texels do not change. `set`, if not null, is composited behind and before the rays.
    Resolver(const gpu::Device& device, RaysPerPixel rays_per_pixel, const RayBatch& rays, const gpu::Buffer& image,
             const TileRanges* listed = nullptr, const SetTargets* set = nullptr);

    const TileRanges* listed;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// With RaysPerPixel::kWhole, the rays of each view must be tiles_of_image(·, samples·width, samples·height), and a
// pixel is the mean of samples² rays. With kFewer, the first cameras of the batch, one per view, have the grids of
// rays. The settings must not be an inspection (assert).
void record_resolve(gpu::Commands& commands, const Resolver& resolver, const ViewLayout& layout,
                    const ResolveSettings& settings);

}  // namespace neuvv::render

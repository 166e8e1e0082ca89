// Resolve: traced rays to an 8-bit sRGB picture.
#pragma once

#include "gpu/commands.h"
#include "render/picture_list.h"
#include "render/set_raster.h"
#include "shared/resolve.h"

namespace neuvv {

enum class Show : uint32_t { kColour = kShowColour, kAlpha = kShowAlpha, kDepth = kShowDepth };

struct ResolveSettings {
    Show show = Show::kColour;
    glm::vec4 background{0};  // linear RGB, opacity (0: the picture keeps its alpha)
    float depth_near_m = 0, depth_far_m = 1;
    bool operator==(const ResolveSettings&) const = default;
};

class Resolver {
  public:
    // `picture`: at least views·width·height R32_UINT texels. `only`: the tiles that see anything; the others stay.
    // `set`: behind and before the rays.
    Resolver(const Device& device, const RayBatch& rays, const Buffer& picture, const TileRanges* only = nullptr,
             const SetRaster* set = nullptr);

  private:
    friend void record_resolve(Commands&, const Resolver&, const ViewLayout&, const ResolveSettings&);
    const TileRanges* only_;
    ComputePass pass_;
    BindingSet set_;
};

// What resolve and upscale pass to their shaders.
ResolvePush resolve_push(const ViewLayout& layout, const ResolveSettings& settings);

// The rays of each view must be tiles_of_picture(·, samples·width, samples·height); a pixel is the mean of samples² of
// them.
void record_resolve(Commands& commands, const Resolver& resolver, const ViewLayout& layout,
                    const ResolveSettings& settings);

}  // namespace neuvv

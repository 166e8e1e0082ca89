// Upscale: rays that are fewer than pixels to a picture.
#pragma once

#include "render/resolve.h"

namespace neuvv {

class Upscaler {
  public:
    // `picture`: at least views·width·height R32_UINT texels, of which the listed tiles are written, and where there is
    // a set all.
    Upscaler(const Device& device, const RayBatch& rays, const Buffer& picture, const TileRanges& ranges,
             const SetRaster* set = nullptr);

  private:
    friend void record_upscale(Commands&, const Upscaler&, const ViewLayout&, const ResolveSettings&);
    const TileRanges* only_;
    ComputePass pass_;
    BindingSet set_;
};

// Where rays stand is as the batch's first cameras say, one a view.
void record_upscale(Commands& commands, const Upscaler& upscaler, const ViewLayout& layout,
                    const ResolveSettings& settings);

}  // namespace neuvv

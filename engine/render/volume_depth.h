// Volume depth: where performers are, for the set's blended pieces.
#pragma once

#include "render/set_raster.h"
#include "render/trace.h"
#include "render/view_layout.h"

namespace neuvv {

class VolumeDepth {
  public:
    // Rays → set.volume_depth.
    VolumeDepth(const Device& device, const RayBatch& rays, const SetRaster& set);

  private:
    friend void record_volume_depth(Commands& commands, const VolumeDepth& pass, const ViewLayout& layout);
    ComputePass pass_;
    BindingSet set_;
};

// After the last instance.
void record_volume_depth(Commands& commands, const VolumeDepth& pass, const ViewLayout& layout);

}  // namespace neuvv

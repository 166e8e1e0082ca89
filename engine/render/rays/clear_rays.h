// Clears the rays of a target before a frame: transparent, at infinite depth, and no tile covered.
#pragma once

#include "render/rays/ray_target.h"

namespace neuvv::render {

struct RayClearer {
    RayClearer(const gpu::Device& device, const RayTarget& target);

    const RayTarget& target;
    gpu::ComputePass list, clear;
    gpu::BindingSet list_set, clear_set;
    bool begun = false;  // whether rays and coverage have been cleared as a whole
};

// To be recorded before the first instance of a frame. The first call clears all rays, and later ones those in tiles
// that are marked as covered, which are the only ones that a frame's passes write. It uses the target's tile list.
void record_clear_rays(gpu::Commands& commands, RayClearer& clearer);

}  // namespace neuvv::render

// The shadow blur pass: the image of the performers as a light sees them, low-passed, becomes their soft shadow map.
#pragma once

#include <span>

#include "gpu/commands.h"
#include "render/volume/trace.h"

namespace neuvv::render {

struct ShadowBlur {
    // Reads the alpha and depth of `rays`, which show kPerformerShadowSide² pixels a view, and writes to `maps` (rg32f,
    // as many texels a map: alpha, metres).
    ShadowBlur(const gpu::Device& device, const RayBatch& rays, const gpu::Buffer& maps);

    gpu::Buffer rows;
    gpu::ComputePass along_rows, along_columns;
    gpu::BindingSet rows_set, columns_set;
};

// Writes map number maps[view] from the rays of each view.
void record_shadow_blur(gpu::Commands& commands, const ShadowBlur& blur, std::span<const uint32_t> maps);

}  // namespace neuvv::render

// The samples of a deep image's pixel, from what its rays pass through.
#pragma once

#include "media/deep_exr.h"
#include "render/rays/ray_intervals.h"

namespace neuvv::render {

constexpr size_t kDeepSamples = 16;        // the most that a pixel has
constexpr float kDeepError = 1.0f / 1024;  // the transmittance at a depth that samples may be wrong by

// The mean transmittance of the rays, as it falls with depth, in pieces of a homogeneous medium: there is a border
// wherever the pieces would be wrong by more than kDeepError, or where they are most wrong until there are `most`
// pieces. Light and alpha of all samples together are those of the mean of the rays. A stretch whose ends are equal is
// a surface.
std::vector<media::DeepSample> deep_samples(std::span<const std::vector<RayStretch>> rays, size_t most = kDeepSamples);

}  // namespace neuvv::render

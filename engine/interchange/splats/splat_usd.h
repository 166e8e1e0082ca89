// Gaussian splats in OpenUSD, as ParticleField3DGaussianSplat of OpenUSD 26.03 and later.
#pragma once

#include <filesystem>
#include <span>

#include "interchange/splats/splats.h"

namespace neuvv::interchange {

// A .usda with one prim; where there are several frames, its attributes have a sample for each, at time codes 0, 1, …,
// `fps` of them a second. Written atomically; throws RuntimeFailure.
void write_splat_usda(const std::filesystem::path& file, std::span<const Splats> frames, double fps,
                      const glm::dvec3& origin = glm::dvec3(0));  // of the splats, a translation in doubles
// About.
size_t usda_bytes_of_splat(uint32_t degree);

}  // namespace neuvv::interchange

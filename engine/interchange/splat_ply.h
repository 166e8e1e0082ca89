// Gaussian splats as the .ply of 3D Gaussian Splatting, which all programs for splats read.
#pragma once

#include <filesystem>

#include "interchange/splats.h"

namespace neuvv::interchange {

// Binary, little-endian: x, y, z, nx, ny, nz (0), f_dc_0…2, f_rest_* (of red, then green, then blue), opacity (its
// logit), scale_0…2 (their logarithms), rot_0…3 (w, x, y, z). Written atomically; throws RuntimeFailure.
void write_splat_ply(const std::filesystem::path& file, const Splats& splats);
size_t ply_bytes_of_splat(uint32_t degree);

// Files of this kind have +Y down, as COLMAP does. Viewers turn them up again by half a turn about z, so that a
// performer who faces +Z still does.
constexpr glm::dquat kPlyRotation{0, 0, 0, 1};

}  // namespace neuvv::interchange

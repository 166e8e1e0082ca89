// Gaussian splats as the .ply of 3D Gaussian Splatting, which all programs for splats read and write.
#pragma once

#include <filesystem>
#include <string>

#include "interchange/splats/splats.h"

namespace neuvv::interchange {

// Binary, little-endian: x, y, z, nx, ny, nz (0), f_dc_0…2, f_rest_* (of red, then green, then blue), opacity (its
// logit), scale_0…2 (their logarithms), rot_0…3 (w, x, y, z). Written atomically; throws RuntimeFailure.
void write_splat_ply(const std::filesystem::path& file, const Splats& splats);
size_t ply_bytes_of_splat(uint32_t degree);

// Splats of a file, how many were left out, and why the first of those was: "splat 12, whose f_dc_1 is nan".
struct PlySplats {
    Splats splats;
    size_t left_out = 0;
    std::string first_left_out;
};
// Reads a binary, little-endian .ply whose vertices have those properties, in any order, of any type, among others.
// Lengths are multiplied by `scale`, and axes stay as they are. An opacity of +inf, the logit of 1, is opaque, one of
// -inf is 0, and so is a size whose logarithm is -inf. Splats are left out that have any other number that is not
// finite, lie or reach farther than 1000 km, have colours beyond ±1e6, or a rotation of no length. Throws InputError
// with the file and what is wrong.
PlySplats read_splat_ply(const std::filesystem::path& file, double scale = 1);

// Files of this kind have +Y down, as COLMAP does. Viewers turn them up again by half a turn about z, so that a
// performer who faces +Z still does.
constexpr glm::dquat kPlyRotation{0, 0, 0, 1};

}  // namespace neuvv::interchange

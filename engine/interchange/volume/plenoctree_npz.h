// A frame as a PlenOctree (Yu et al. 2021), which svox and volrend read.
#pragma once

#include <filesystem>

#include "slice/slice.h"

namespace neuvv::interchange {

// Writes the .npz of an N3Tree of svox: leaves and densities are exactly those of the volume, up to fp16, in the file's
// axes, which have +Z up: (x, y, z) → (x, −z, y). Spherical harmonics have the volume's degree. Their sigmoid is sRGB,
// as PlenOctrees have it and as their renderers composite it; voctree::read_plenoctree reads the file. A volume without
// leaves becomes a node of empty cells. Written atomically; throws InputError with the file for more than 2^27 nodes,
// and RuntimeFailure.
void write_plenoctree(const std::filesystem::path& file, const slice::Slice& volume);

// About how many bytes a volume takes, packed.
uint64_t plenoctree_bytes(const slice::Slice& volume);

}  // namespace neuvv::interchange

// Reads PlenOctrees (Yu et al. 2021): static scenes in .npz files of svox' N3Tree.
#pragma once

#include <filesystem>

#include "voctree/voctree.h"

namespace neuvv::voctree {

enum class PlenoctreeColours {
    kLinear,    // colours are decoded to linear light (decode_colours.h), as a VOctree has them
    kAsStored,  // the file's SH, up to rounding; their sigmoid is sRGB
};

// Reads a PlenOctree as a clip of one frame. A = (1), and w^σ is the file's σ; its unit is 1/m, as the file's unit of
// length is taken to be metres. γ = π/2 in all leaves, and of the colour weights only w_llm = k_lm / R_ll(π/2) differ
// from 0, so that k are the SH coefficients of the slice; svox' Y_lm are those of sh.glsl times (−1)^m. The box is the
// file's, not rotated; often its +Z is up. Leaves of σ ≤ 0 are left out. Reading takes about six times the memory of
// the array `data`.
//
// Accepted formats are SH1, SH4, SH9, SH16 and RGBA, in fp16 or fp32. Throws InputError for other formats, quantised
// trees, leaves deeper than 2·kMaxNodeLevels, trees of which all leaves are empty, and damaged files.
VOctree read_plenoctree(const std::filesystem::path& path, PlenoctreeColours colours = PlenoctreeColours::kLinear);

struct PlenoctreeBox {
    glm::vec3 min, size;  // metres
};
// Reads the box alone. Throws InputError where the file or its box is damaged.
PlenoctreeBox read_plenoctree_box(const std::filesystem::path& path);

}  // namespace neuvv::voctree

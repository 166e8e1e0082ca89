// PlenOctrees (Yu et al. 2021): scenes at rest, in .npz files of svox' N3Tree.
#pragma once

#include <filesystem>

#include "voctree/voctree.h"

namespace neuvv::voctree {

enum class PlenoctreeColours {
    kLinear,    // decoded (decode_colours.h): what a VOctree holds
    kAsStored,  // the file's SH to rounding; their sigmoid is what a display is sent, sRGB
};

// A clip of one frame. A = (1) and w^σ is the file's σ, whose unit is 1 over the file's unit of length, taken as
// metres. γ = π/2 in all leaves, and w_llm = k_lm / R_ll(π/2) alone, so that k are the slice's coefficients; svox' Y_lm
// are ours times (−1)^m. The box is the file's world as it stands, often with +Z up. Leaves of σ ≤ 0 are left out.
// Memory: about six times that of the array `data`.
//
// SH1, SH4, SH9, SH16 and RGBA, in fp16 or fp32. Throws InputError for other formats, for quantised trees, for leaves
// deeper than 2·kMaxNodeLevels, where all leaves are empty, and for damage of any kind.
VOctree read_plenoctree(const std::filesystem::path& path, PlenoctreeColours colours = PlenoctreeColours::kLinear);

struct PlenoctreeBox {
    glm::vec3 min, size;  // metres
};
// Its box alone; of the rest nothing is read. Throws InputError.
PlenoctreeBox read_plenoctree_box(const std::filesystem::path& path);

}  // namespace neuvv::voctree

// Reads PlenOctrees (Yu et al. 2021): static scenes in .npz files of svox' N3Tree.
#pragma once

#include <filesystem>

#include "voctree/voctree.h"

namespace neuvv::voctree {

enum class PlenoctreeColours {
    kLinear,    // decoded to linear light (decode_colours.h), as those of other clips are
    kAsStored,  // the file's SH, up to rounding; their sigmoid is sRGB (VOctree::has_srgb_colours)
};

// Which of a PlenOctree's axes is up, which its file does not say. volrend takes it to be +Z, as those of the NeRF
// scenes are.
enum class UpAxis { kZ, kY };

// Reads a PlenOctree as a clip of one frame. With kZ it is turned to +Y up, (x, y, z) → (x, z, −y), as the poses of a
// transforms.json are (interchange/camera/transforms.h). A = (1), and w^σ is the file's σ; its unit is 1/m, as the
// file's unit of length is taken to be metres. γ = π/2 in all leaves, and of the colour weights only w_llm = k_lm /
// R_ll(π/2) differ from 0, so that k are the SH coefficients of the slice; svox' Y_lm are those of sh.glsl times
// (−1)^m. Leaves of σ ≤ 0 are left out; a σ above kMaxHalf becomes that, which is as opaque. Reading takes about seven
// times the memory of the array `data` where that is fp16 of degree 1.
//
// Accepted formats are SH1, SH4, SH9, SH16 and RGBA, in fp16, in fp32, or quantised by volrend's compress_octree.py.
// Throws InputError for other formats, trees in NDC, leaves deeper than 2·kMaxNodeLevels, trees of which all leaves are
// empty, and damaged files.
VOctree read_plenoctree(const std::filesystem::path& path, PlenoctreeColours colours = PlenoctreeColours::kLinear,
                        UpAxis up = UpAxis::kZ);

// Reads the box alone: its least corner and its size, in metres, turned as read_plenoctree does. Throws InputError
// where the file or its box is damaged, or the tree is in NDC.
std::pair<glm::vec3, glm::vec3> read_plenoctree_box(const std::filesystem::path& path, UpAxis up = UpAxis::kZ);

// Reads the box around the leaves that read_plenoctree reads: its corners, in metres. It takes half as long, because
// colours are not decoded, and does not throw where a single one of them is no number.
std::pair<glm::dvec3, glm::dvec3> read_plenoctree_leaf_box(const std::filesystem::path& path, UpAxis up = UpAxis::kZ);

}  // namespace neuvv::voctree

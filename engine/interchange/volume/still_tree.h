// Trees of one frame, made leaf by leaf of what other programs wrote.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "voctree/voctree.h"

namespace neuvv::interchange {

// Leaves that are less opaque along their edge are left out.
constexpr float kLeastImportedOpacity = 1e-3f;
// Colours in linear light are cut to what lies between this and 1 less this, as no sigmoid is 0 or 1.
constexpr float kLeastImportedColour = 0.002f;

// A box of cells of one size, the cells of a tree's depth, in a lattice that is the same for all frames of a clip, so
// that what stands still has the same cells in all of them.
struct CellBox {
    glm::ivec3 first{0};  // of the lattice's cells
    uint32_t depth = 2;   // even; the box has 2^depth cells along each side

    // A box around the cells from `low` to `high`, both included, that begins at a multiple of `step`, a power of two.
    // Throws InputError with `file` and `hint`, what to do, where it would have more cells than a tree may have.
    static CellBox around(const glm::ivec3& low, const glm::ivec3& high, int step, const std::string& file,
                          const Fix& hint);
};

struct StillLeaves {
    uint32_t degree = 0;  // of the harmonics
    std::vector<voctree::LeafPosition> positions;
    // Of each leaf: σ in 1/m, then k_lm of R, G and B, whose sum's sigmoid is linear light.
    std::vector<float> values;

    uint32_t values_of_leaf() const { return 1 + 3 * sh_count(degree); }
};

// k_00 of a colour in linear light, cut, that is the same in all directions.
float constant_harmonic(float linear);

// `origin_m`: the corner of the lattice's cell 0. The leaves must lie in the box; where two overlap, the first of the
// tree's walk stays.
voctree::VOctree still_tree(const StillLeaves& leaves, const CellBox& box, const glm::dvec3& origin_m,
                            const glm::dvec3& cell_m, float fps);

}  // namespace neuvv::interchange

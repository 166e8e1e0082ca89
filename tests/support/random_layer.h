// Seeded random layers of paint for tests: colours, densities, both, erased and revived leaves, in parts of the clip,
// at fractions of frames, too.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random_tree.h"
#include "voctree/edit_layer.h"

namespace neuvv::test {

inline voctree::EditLayer random_layer(const voctree::VOctree& tree, Random& random) {
    voctree::EditLayer layer{voctree::painted_field(tree), {}};
    std::vector<voctree::LeafEdit> edits;
    for (uint32_t i = 0; i < tree.leaf_count; ++i) {
        voctree::LeafEdit edit;
        edit.leaf = random.below(tree.leaf_count);
        const double last = tree.frames - 1.0;
        edit.first = static_cast<float>(std::floor(8 * random.uniform(0, last)) / 8);
        edit.last = static_cast<float>(random.uniform(double{edit.first}, last));
        if (random.below(4) > 0) {
            for (int c = 0; c < 3; ++c) edit.colour[c] = static_cast<float>(random.below(65)) / 64;
            edit.alpha = random.below(2) ? 1.0f : static_cast<float>(random.below(65)) / 64;
        }
        if (random.below(2)) edit.sigma = random.below(3) ? static_cast<float>(random.below(256)) / 16 : 0.0f;
        edits.push_back(edit);
    }
    voctree::add_edits(layer, edits);
    EXPECT_EQ(voctree::defect_of(layer), "");
    return layer;
}

}  // namespace neuvv::test

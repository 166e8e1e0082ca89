#include "render/volume/slices/walk_shape.h"

namespace neuvv::render {

void set_root(WalkShape& shape, const LeavesOfDepth& leaves) {
    uint32_t finest = 1, odd = 0, all = 0;
    for (uint32_t depth = 1; depth < leaves.size(); ++depth) {
        if (leaves[depth] > 0) finest = depth;
        all += leaves[depth];
        if (depth % 2 == 1) odd += leaves[depth];
    }
    const uint32_t above = odd > all / 2 && finest < 2 * kMaxNodeLevels ? 1 : 0;
    shape.leaves = leaves;
    shape.node_levels = (finest + above + 1) / 2;
    shape.scale = 1 + above;
}

}  // namespace neuvv::render

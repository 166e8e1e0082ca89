// Holes in a surface: leaves that are empty in a frame although their neighbours are not.
#pragma once

#include "voctree/voctree.h"

namespace neuvv::training {

// A leaf that died in a frame gets no gradient there, however much its rays want it back. Gives a little density to
// each leaf in each frame in which it has none and at least four of the leaves at the middles of its six faces do: the
// surface goes on around it. That may also be one that no ray used, or that the hull forbids: where rays reach it, it
// grows or dies again, and a hidden one stays until the next change of the tree. Neighbours are told as they were
// before any revived; beside finer leaves the one towards +x, +y, +z counts. Returns how often. Cells must be cubes, as
// training's are. Trees whose frames share bases stay as they are.
size_t revive_holes(voctree::VOctree& tree);

}  // namespace neuvv::training

// Closes holes in surfaces: leaves that are empty in a frame although their neighbours are not.
#pragma once

#include "voctree/voctree.h"

namespace neuvv::training {

// A leaf that is empty in a frame gets no gradient there, even where the loss needs it back. This function gives a
// leaf a little density in each frame in which it has none and at least four of its six neighbours have some, as the
// surface then goes on around it. The leaf may also be one that no ray used, or that the hull forbids: where rays see
// it, training makes it denser or empty again; where it is hidden, it stays until the tree changes again.
//
// A neighbour is the leaf at the centre of a face; beside finer leaves it is the one towards +x, +y, +z. Densities of
// neighbours are those before the call. Cells must be cubes, as those of training are. Trees whose frames share bases
// are not changed. Returns the number of pairs of leaf and frame that were revived.
size_t revive_holes(voctree::VOctree& tree);

}  // namespace neuvv::training

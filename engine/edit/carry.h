// Carrying edits from one tree of a performer to another, as from a segment of a clip to the next, whose leaves lie
// elsewhere.
#pragma once

#include <span>
#include <vector>

#include "edit/select.h"

namespace neuvv::edit {

// The edits, each of another leaf of `from`, as edits of leaves of `to`, in order of leaf and without frames. A leaf
// gets the edit of the largest alpha in it, so that a painted surface stays painted where the two trees' leaves lie
// apart by a part of a leaf, and the mean density of edits that cover half of it or more. What lies in a leaf is found
// at samples, so that edits of leaves less than a quarter of its size may be missed.
std::vector<voctree::LeafEdit> carried(const Canvas& from, std::span<const voctree::LeafEdit> edits, const Canvas& to);

}  // namespace neuvv::edit

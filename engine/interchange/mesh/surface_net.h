// The surface of a solid as a closed mesh.
#pragma once

#include "interchange/mesh/solid.h"
#include "interchange/mesh/triangle_mesh.h"

namespace neuvv::interchange {

// Surface nets (Gibson, "Constrained elastic surface nets", 1998): a vertex where 2×2×2 cells are not all on the same
// side, and a quad between each two cells that are on different ones. A vertex begins at the mean of the points where
// opacity, linear between the centres of cells, passes the level. Vertices are then smoothed, and stay among the
// centres of their eight cells. Each edge has two triangles, and those around each vertex are one ring.
TriangleMesh surface_of(const Solid& solid);

}  // namespace neuvv::interchange

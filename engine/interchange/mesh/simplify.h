// Fewer triangles by quadric errors.
#pragma once

#include <functional>

#include "interchange/mesh/triangle_mesh.h"

namespace neuvv::interchange {

// Merges neighbouring vertices of a closed manifold, those first whose planes the merged vertex is nearest to (Garland
// and Heckbert, "Surface simplification using quadric error metrics", 1997), until no more than `most_triangles` are
// left. The mesh stays a closed manifold of the same Euler number: what would change that or turn a triangle over is
// not merged, so that a mesh of many small parts may keep more. Calls `between` some times, which may throw.
TriangleMesh simplified(
    const TriangleMesh& mesh, size_t most_triangles, const std::function<void()>& between = [] {});

}  // namespace neuvv::interchange
